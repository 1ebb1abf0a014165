/* SPDX-License-Identifier: MIT */
/* gxfem.h - cuts deformable bodies: exact where others guess. Part of gxfem 0.2.0.
 *
 * A body is a tetrahedral mesh with a material. Cuts are triangle surfaces in material (rest) coordinates, any number
 * of them, crossing each other as they like. The mesh is never remeshed: where material separates, nodes get further
 * copies of their displacement (GXFEM Eq. 18), and every integral over a cut element is exact. Implicit time steps move
 * it (gxfem_solve.h).
 *
 * In one source file: #define GXFEM_IMPLEMENTATION before #include "gxfem.h", and link with -lm. Everywhere else: the
 * #include alone. GXFEM_STATIC makes all functions static. All four headers must be there.
 *
 * One minute:
 *
 *     #define GXFEM_IMPLEMENTATION
 *     #include "gxfem.h"
 *     #include <stdio.h>
 *     int main(void) {
 *         const double x[12] = {0,0,0, 1,0,0, 0,1,0, 0,0,1}, s[9] = {-9,-9,.25, 9,-9,.25, 0,9,.25};
 *         const uint32_t tet[4] = {0, 1, 2, 3}, tri[3] = {0, 1, 2};
 *         gx_body_desc desc = {0};
 *         gx_surface sheet = {0};
 *         gx_cut_desc cut = {0};
 *         gx_step_desc step = {0};
 *         gx_view view;
 *         gx_body *body;
 *         desc.positions = x; desc.node_count = 4; desc.elements = tet; desc.element_count = 1;
 *         desc.young = 1e6; desc.poisson = 0.4; desc.density = 1000;
 *         if (gx_body_create(&desc, &body, NULL) != GX_OK) return 1;
 *         sheet.vertices = s; sheet.vertex_count = 3; sheet.triangles = tri; sheet.triangle_count = 1;
 *         cut.surfaces = &sheet; cut.surface_count = 1;
 *         if (gx_body_cut(body, &cut, NULL, NULL) != GX_OK) return 1;
 *         step.dt = 0.033; step.gravity[2] = -9.81;
 *         if (gx_body_step(body, &step, NULL, NULL) != GX_OK || gx_body_view(body, &view, NULL) != GX_OK) return 1;
 *         printf("%u fragments, %u unknowns\n", (unsigned)view.fragment_count, (unsigned)(3 * view.copy_count));
 *         gx_body_destroy(body);
 *         return 0;
 *     }
 *
 * Contents (search for >>name):
 *     >>shared     result codes, allocator
 *     >>creating   bodies
 *     >>cutting    surfaces, cuts, solidified sheets
 *     >>viewing    cells, copies, fragments, motion
 *     >>anchoring  material points that survive cuts
 *     >>stepping   held regions, time steps
 *     >>touching   contact of pieces
 *     >>drawing    the visual surface, rays
 *     >>locating   points of space: what material is there; where material is
 *     >>slicing    blades in space
 *     >>hashing    of the topology, of the state
 *     >>saving     save and load, clone and restore
 *     then, under GXFEM_IMPLEMENTATION, in the order of a cut; functions call their own and earlier sections only:
 *     what a body is made of:    >>state >>body >>columns
 *     tools:                     >>memory >>basics >>mesh >>search >>copies >>transaction >>complex >>numbering
 *     a cut:                     >>surfaces >>pinches >>arrange >>solids >>materials >>links >>cells >>components
 *                                >>integrals >>sheets >>specks >>settle >>cut
 *     a sheet's thickness:       >>solidify
 *     what is held and whole:    >>anchors >>regions >>grips >>map >>fragments >>motion
 *     what acts on it:           >>attached >>supports >>model
 *     the skin:                  >>corners >>vertices >>faces >>skinning
 *     points and rays:           >>tree >>locate >>nearest >>hits >>rays
 *     a step, with contact:      >>touch >>colliders >>meeting >>seeking >>pressing >>telling
 *                                >>step
 *     a blade in space:          >>layers >>edges >>relations >>fronts >>glances >>strokes >>ways >>blade
 *                                >>contacts >>carve
 *     beginning, end, bytes:     >>grid >>create >>hashes >>stream >>scabbard >>save
 *
 * Words. Facet: a polygon inside an element or in an element face, made by cuts. Wall: a facet that a sheet covers.
 * Cell: a connected part of one element after cutting (GXFEM Eq. 20). Link: all facets of the face between two elements
 * that no wall covers and that connect the same two cells. Copy: a node's displacement for one connected set of cells
 * around the node (GXFEM Eq. 18). Fragment: a connected set of cells of the body.
 *
 * Exact: the set of cells and their links, hence copies and fragments. Decisions are signs of polynomials in the given
 * coordinates (gxfem_boolean.h). Rounded once, to doubles: volumes, masses and vertices.
 *
 * Not there yet: contact of two bodies of the library (pieces of one touch each other and the host's rigid bodies:
 * gx_body_contact); surfaces given in the deformed state (a moving edge is: gx_blade); unknowns within a partly cut
 * element (a sheet that ends inside an element separates nothing there until another sheet completes it).
 *
 * Limits: fewer than 2^28 elements a body (2^24 where pointers have 32 bits), fewer than 2^30 cells and 2^30 copies
 * for steps, some 1.4e9 of each other kind of object, 5e8 vertices and triangles a surface (GX_ERROR_LIMIT). A body's
 * coordinates are at most 2^100 (1.3e30), its longest side is at least 2^-100 (7.9e-31), each element has a mass of
 * 2^-700 ... 2^700. So all volumes, masses, centres and inertia are finite, those of whole bodies are normal numbers,
 * and floats hold the skin. Divided by the body's size, coordinates of bodies and cuts are 0 or 2^-128 ... 2^128 in
 * absolute value (GX_ERROR_RANGE). One thread at a time may use a body. There is no global state, no output, no clock.
 * A call takes less than 48 kB of stack, besides that of the caller's own functions. gx_body_load takes more where one
 * edge, face or element was divided over and over: 50 bytes for each time in a row.
 *
 * References: GXFEM = Ton-That, Kry, Andrews: Generalized eXtended Finite Element Method for Deformable Cutting via
 * Boolean Operations (2024). RXFEM = Koschier, Bender, Thuerey: Robust eXtended Finite Elements for Complex Cutting of
 * Deformables (2017).
 */
#ifndef GXFEM_H
#define GXFEM_H

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
    size_t surface; /* of a cut: which of its surfaces; else SIZE_MAX */
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

#include "gxfem_solve.h"

#ifdef __cplusplus
extern "C" {
#endif

/* >>creating: units are the caller's, here SI ---------------------------------------------------------------------- */

typedef struct gx_body gx_body; /* opaque */

typedef struct gx_material {
    gxs_material elastic;
    double density; /* kg/m3, > 0 */
} gx_material;

/* A sheet separates the material on its two sides. It may be open, closed or curved, cross itself, be non-manifold. A
   solid is closed and consistently oriented; it removes the material around which it winds. A solid that keeps removes
   all other material; of several in one cut, what lies in all of them stays. A surface of material is closed like a
   solid. What it winds around is of that material from then on; of several in one cut the last one counts. Where two
   materials adjoin is an interface: nothing is cut there, and cells on its two sides move by the same copies. A sheet
   that coincides with an interface, and gx_cut_desc.release, separate them. */
enum { GX_SURFACE_SHEET = 0, GX_SURFACE_SOLID = 1, GX_SURFACE_KEEP = 2, GX_SURFACE_MATERIAL = 3 };
typedef struct gx_surface {
    const double *vertices; /* vertex_count x 3, material coordinates, m */
    size_t vertex_count;
    const uint32_t *triangles; /* triangle_count x 3 */
    size_t triangle_count;
    uint32_t kind;        /* GX_SURFACE_ */
    const float *texture; /* vertex_count x 2: texture coordinates of the faces that it cuts; NULL: all 0 */
    /* The surface cuts only the cells of these slots (gx_view.cell_slot), whatever the cut's scope is. All surfaces of
       a cut see the cells of before the cut. A slot whose cell was removed stands for nothing. NULL: the cut's scope */
    const uint32_t *scope_slots; /* scope_slot_count, below gx_view.slot_count */
    size_t scope_slot_count;
    uint32_t material; /* of GX_SURFACE_MATERIAL and in a shape: an index below gx_body_desc.material_count */
} gx_surface;

/* A shape in place of a mesh: the body is all that its surfaces wind around, carved exactly out of a grid. Its volume
   is theirs to rounding, its skin is their triangles (divided at the grid's elements), its mass and inertia follow. The
   grid has cubes with a node at each corner and in each middle, and 12 tetrahedra for a cube: each has two middles and
   two corners. Elements that the surfaces neither meet nor wind around are not made. One of cells, edge and unknowns is
   given, the others are 0. */
typedef struct gx_shape {
    /* surface_count. Each is closed and oriented alike, of any number of parts, and may cross itself. A part that faces
       inward, inside of another part of the same surface, is a cavity. Where they overlap, or one lies in another, the
       material is that of the last one: first flesh, then the bone in it. kind and scope_slots are not read */
    const gx_surface *surfaces;
    size_t surface_count;
    uint32_t cells;  /* cubes along the longest side of the box around all surfaces */
    double edge;     /* m: of a cube */
    size_t unknowns; /* the finest grid of whole cells whose elements have at most this many: 3 for each node */
} gx_shape;

typedef struct gx_body_desc {
    const double *positions; /* node_count x 3, material coordinates, m */
    size_t node_count;
    const uint32_t *elements; /* element_count x 4 node indices, positive volume: det(x1-x0, x2-x0, x3-x0) > 0 */
    size_t element_count;
    double young;                 /* Pa, > 0: of one stable neo-Hookean material; used if materials is NULL */
    double poisson;               /* 0 <= poisson < 0.5; likewise */
    double density;               /* kg/m3, > 0; likewise */
    const gx_material *materials; /* material_count, or NULL */
    size_t material_count;
    const uint32_t *element_materials; /* element_count, below material_count; NULL: all of materials[0] */
    const float *texture;              /* node_count x 2: texture coordinates of the outer surface; NULL: all 0 */
    /* A share of an element, below 1. A copy follows others if all parts of elements around it are smaller (see
       gx_body_step). 0: 1e-3. 1e-300: none follow, and slivers may be flung away. */
    double support_below;
    /* In thicknesses of elements, 0 ... 1000. Where material is thinner, its copies carry an affine motion each (are
       affine), so that sheets bend as they should. Creation and cuts find it, the latter among what they touch; an
       affine copy stays so. A layer of cubes of five or six elements has a thickness of 0.94; 1 is a good value.
       0: none, at no cost. Other values: pairs of a step need their anchors (gx_step_desc.pair_anchors) */
    double affine_below;
    gx_allocator allocator;      /* zero: malloc, free, realloc */
    double (*clock)(void *user); /* seconds, for the reports' timings and the steps' budgets; NULL: timings are 0 */
    void *clock_user;
    gx_jobs jobs; /* the host's threads, for the steps; zero: none */
    /* NULL: the mesh above. Else positions, elements, element_materials and texture are NULL, their counts 0, and the
       body is as a cut has left it: gx_view.epoch is not 0, and surface n of the shape is surface n of the body's cuts,
       for the skin and its texture. */
    const gx_shape *shape;
} gx_body_desc;
/* Creates a body. The arrays of the description are copied. failure.index is a node, element or material.
   Errors: ARGUMENT, EMPTY, INDEX, NOT_FINITE, RANGE (a node is too far out, an element too heavy or too light, or,
   index SIZE_MAX, the body is too small), INVERTED, FLAT (exactly, or in doubles), OVERLAP, LIMIT, MEMORY,
   CONFIGURATION. Of a shape, failure.surface and index name surface and vertex or triangle: as gx_body_cut, and EMPTY
   (it winds around nothing), LIMIT (the grid has too many cubes; or "shape.unknowns": no grid has so few), RANGE (the
   grid is too fine for coordinates so far from the origin). */
GXFEM_API gx_result gx_body_create(const gx_body_desc *desc, gx_body **body, gx_failure *failure /* or NULL */);
GXFEM_API void gx_body_destroy(gx_body *body); /* or NULL */

/* >>cutting -------------------------------------------------------------------------------------------------------- */

typedef struct gx_cut_desc {
    const gx_surface *surfaces;
    size_t surface_count;
    /* The cut affects only these fragments: indices below gx_view.fragment_count, not ids. Both counts 0: the whole
       body. A surface may have a scope of its own in place of this one. */
    const uint32_t *scope_fragments;
    size_t scope_fragment_count;
    const uint32_t *scope_cells; /* and these cells: indices below gx_view.cell_count */
    size_t scope_cell_count;
    /* 0 ... 1: links of touched cells with a smaller share of their face are severed; 0: none. Links of cells that have
       an interface in their element are not */
    double sever_below;
    /* release_count x 2: pairs of materials, the second or both GX_ANY_MATERIAL: what adjoins there comes apart,
       within the cut's scope, where both sides are in it. It does so after the surfaces have given materials. With
       pairs, a cut may have no surfaces */
    const uint32_t *release;
    size_t release_count;
} gx_cut_desc;
#define GX_ANY_MATERIAL UINT32_MAX /* but the one of the other side */
typedef struct gx_cut_report {
    size_t touched_elements, created_cells, removed_cells, created_copies, removed_copies;
    size_t ignored_triangles; /* of zero area */
    size_t severed_links;
    /* smallest link area / face area among the links of the cells that this cut touched, severed ones included; 1 if
       none is smaller */
    double min_link_ratio;
    double removed_volume; /* m3 */
    double seconds_arrangement, seconds_enrichment, seconds_integrals;
} gx_cut_report;
/* Cuts by all surfaces at once. Displacement and velocity are the same functions of material points before and after.
   On an error the body is exactly as it was; failure.surface is the surface, failure.index as named here. A field of a
   surface reads "surfaces.vertices".
   Some cuts of a body that has lost material also give back the memory which that has held. Such a cut goes through
   all that was cut before, 0.1 us for each leaf, facet, edge and point of it. Slots, ids, hits and anchors stay valid.
   Errors: ARGUMENT, EMPTY, INDEX (triangle, place in a scope, pair), NOT_FINITE (vertex), RANGE (vertex), NOT_CLOSED
   (triangle), LIMIT, MEMORY. */
GXFEM_API gx_result gx_body_cut(gx_body *body, const gx_cut_desc *desc, gx_cut_report *report /* or NULL */,
                                gx_failure *failure /* or NULL */);

/* Makes a sheet solid (GXFEM section 4.1): offsets it by thickness/2 (m) to both sides along its vertex normals and
   closes the rim. Vertices where normals cancel are not offset. After an error the output means nothing.
   solid_vertices: room for 2 x vertex_count x 3; solid_triangles: room for 8 x triangle_count x 3; the counts are
   written. Errors: ARGUMENT, EMPTY, INDEX (triangle), NOT_FINITE (vertex), RANGE (a vertex: a sum or difference of
   coordinates is beyond doubles), LIMIT, MEMORY. */
GXFEM_API gx_result gx_surface_solidify(const gx_surface *sheet, double thickness, double *solid_vertices,
                                        size_t *solid_vertex_count, uint32_t *solid_triangles,
                                        size_t *solid_triangle_count, const gx_allocator *allocator /* or NULL */,
                                        gx_failure *failure /* or NULL */);

/* >>viewing -------------------------------------------------------------------------------------------------------- */

/* What cuts have done to a fragment */
enum {
    GX_FRAGMENT_UNCHANGED = 0,
    GX_FRAGMENT_TOUCHED, /* cut but whole, or smaller: by partial cuts or removed material */
    GX_FRAGMENT_SPLIT,   /* fell apart; this is the heaviest fragment of it (the first of equals) and keeps the id */
    GX_FRAGMENT_CREATED  /* fell off another one; its id is new, fragment_origin is the other's */
};

/* The state of a body. The arrays are the body's, valid until the next cut, restore or its destruction.
   fragment_origin, fragment_change and removed_ids tell what has become of fragments since the last view before a cut.
   Several cuts between two views count as one change. The creation counts as a view. Views without a cut between them
   are equal. */
typedef struct gx_view {
    size_t node_count, element_count;
    size_t cell_count;             /* kept cells, sorted by element */
    const uint32_t *cell_element;  /* cell_count */
    const uint32_t *cell_copies;   /* cell_count x 4 */
    const double *cell_volume;     /* cell_count, m3 */
    const uint32_t *cell_fragment; /* cell_count */
    /* cell_count, below slot_count. A slot names a cell across cuts, while cell_ arrays are sorted anew. Of the parts
       into which a cut divides a cell one keeps the slot; the others have new ones, from the slot_count of before on.
       No slot is used again. The first cells of elements have those below element_count. */
    const uint32_t *cell_slot;
    size_t slot_count;
    const uint32_t *slot_parent; /* slot_count: the slot that was divided, which is smaller; of a first cell: itself */
    size_t copy_count;
    const uint32_t *copy_node; /* copy_count */
    const uint8_t *copy_held;  /* copy_count, 1: held by a region (gx_body_hold) */
    /* copy_count: the first of the regions that hold the copy, which moves it; UINT32_MAX: none. Or NULL: no region
       holds anything */
    const uint32_t *copy_region;
    /* Names this numbering of copies. A cut that creates or removes copies begins a new one; other cuts keep it. 0: no
       cut has begun one yet. Bodies that were cut alike have the same epoch, others have different ones. */
    uint64_t epoch;
    /* copy_count x 3, m. The caller may write it; then a step of GXS_BDF1 must come before the next of GXS_BDF2. */
    double *displacement;
    double *velocity; /* copy_count x 3, m/s; likewise */
    /* copy_count, s: for how long the copy has been slower than sleep_speed. The caller may write 0 to wake it. A copy
       whose state was written since the last step wakes at the next call that notices, whether that succeeds or not. */
    double *rest_time;
    size_t fragment_count;
    const double *fragment_volume; /* fragment_count, m3 */
    const double *fragment_mass;   /* fragment_count, kg */
    const double *fragment_center; /* fragment_count x 3, centre of mass, material coordinates, m */
    /* fragment_count x 6, about the centre, material coordinates: 00 01 02 11 12 22, kg m2 */
    const double *fragment_inertia;
    const uint32_t *fragment_id;     /* fragment_count: 1, 2 ...; never used again for another fragment */
    const uint32_t *fragment_origin; /* fragment_count: id of the fragment that it was part of before the change */
    const uint32_t *fragment_change; /* fragment_count: GX_FRAGMENT_ */
    size_t removed_count;
    const uint32_t *removed_ids; /* removed_count: ids of fragments that the change removed entirely */
    double volume, mass;         /* of the body, m3 and kg */
    /* copy_count, 1: the copy is affine (gx_body_desc.affine_below). A cell moves a material point X by the sum of
       N_i (a_i + A_i (X - X_i)) over its copies, with a the displacement, X_i at the copy's node, A = 0 where a copy is
       not affine. NULL, like the next two, where affine_below is 0 */
    const uint8_t *copy_affine;
    const double *affine;      /* copy_count x 9: the columns of A, without unit. Only steps and restores change it */
    const double *affine_rate; /* copy_count x 9, 1/s */
    /* The mesh, as it was given or made for a shape. Both stay until the body's destruction or restore */
    const double *positions;       /* node_count x 3, material coordinates, m */
    const uint32_t *elements;      /* element_count x 4 */
    const uint32_t *cell_material; /* cell_count; NULL: the body has one material only */
} gx_view;
/* Brings the view up to date. Errors: ARGUMENT, MEMORY, LIMIT (no ids left). */
GXFEM_API gx_result gx_body_view(gx_body *body, gx_view *view, gx_failure *failure /* or NULL */);

/* How a fragment moves: integrals over its deformed shape with the consistent mass */
typedef struct gx_motion {
    double mass;        /* kg */
    double center[3];   /* centre of mass, m, in space */
    double inertia[6];  /* about the centre: 00 01 02 11 12 22, kg m2 */
    double velocity[3]; /* of the centre: momentum / mass, m/s */
    /* inverse of inertia times angular momentum about the centre, 1/s; 0 about axes with hardly any inertia (of a point
       or a line) */
    double angular_velocity[3];
    double energy; /* kinetic, J */
} gx_motion;
/* Computes the motions of all fragments from the present displacement and velocity, in the order of gx_view.
   motions: room for capacity, at least gx_view.fragment_count. After an error the output means nothing.
   Errors: ARGUMENT, CAPACITY, NOT_FINITE (a copy's displacement or velocity), RANGE (a motion is beyond doubles),
   MEMORY, LIMIT. */
GXFEM_API gx_result gx_body_motion(gx_body *body, gx_motion *motions, size_t capacity,
                                   gx_failure *failure /* or NULL */);

/* >>anchoring ------------------------------------------------------------------------------------------------------ */

/* A point of the material that stays what it is through cuts, removal, saving and going back. It names no copy, cell or
   slot, so nothing makes it stale. It may be kept and copied. */
typedef struct gx_anchor {
    uint32_t element;
    double position[3]; /* in the element, material coordinates, m */
    /* The side: if a cut passes through position, exactly, the anchor goes with the part towards this point. If the cut
       passes through both, it goes with the part in front of the triangle's plane */
    double toward[3];
} gx_anchor;
/* Makes an anchor of a material point in an element. Where walls meet at the point, it belongs to a part that is left.
   A point that is off the element, or off what is left of it, by less than 1e-6 of the element's size, is moved there.
   Errors: ARGUMENT, INDEX (element), NOT_FINITE, RANGE, EMPTY (the point is not in what is left of the element), FLAT
   (the part there is too thin for points given by doubles), MEMORY, LIMIT. */
GXFEM_API gx_result gx_body_anchor(gx_body *body, uint32_t element, const double material[3], gx_anchor *anchor,
                                   gx_failure *failure /* or NULL */);
/* Gives the copies and weights that move an anchor now, and where it is. Errors: ARGUMENT (also: its position is not in
   its element), INDEX (its element), NOT_FINITE, RANGE, EMPTY (its material is gone). */
GXFEM_API gx_result gx_body_anchor_point(gx_body *body, const gx_anchor *anchor, gxs_point *point /* or NULL */,
                                         double position[3] /* in space, m; or NULL */,
                                         gx_failure *failure /* or NULL */);
/* Tells which anchors have lost their material: lost[i] becomes 1. After an error the output means nothing. Errors:
   ARGUMENT, INDEX, NOT_FINITE, RANGE; failure.index: anchor. */
GXFEM_API gx_result gx_body_lost_anchors(gx_body *body, const gx_anchor *anchors, size_t count,
                                         uint8_t *lost /* count */, gx_failure *failure /* or NULL */);

/* >>stepping ------------------------------------------------------------------------------------------------------- */

/* Which material is held, in material coordinates, m. kind says which members are read; zero the others. Regions are
   open: what lies on their boundary is outside. */
enum {
    GX_REGION_HALF_SPACE = 0, /* X[axis] < value (side -1) or > value (side +1) */
    GX_REGION_BOX,            /* low < X < high along each axis */
    GX_REGION_SPHERE,         /* |X - center| < radius */
    GX_REGION_SURFACE,        /* around which a closed surface winds */
    GX_REGION_NODES,          /* at these nodes of the mesh */
    GX_REGION_ANCHORS         /* at these anchors */
};
typedef struct gx_region {
    uint32_t axis;
    int32_t side;
    double value;
    uint32_t kind; /* GX_REGION_ */
    double low[3], high[3];
    double center[3], radius;
    const gx_surface *surface; /* vertices and triangles are read */
    const uint32_t *nodes;     /* node_count */
    size_t node_count;
    const gx_anchor *anchors; /* anchor_count */
    size_t anchor_count;
} gx_region;
GXFEM_API gx_region gx_region_half_space(uint32_t axis, int side, double value);
GXFEM_API gx_region gx_region_box(const double low[3], const double high[3]);
GXFEM_API gx_region gx_region_sphere(const double center[3], double radius);
/* Holds copies at their present displacement (Dirichlet), now and after later cuts: those whose node is in a region and
   whose own cells have material there. Those of anchors: the copies that move them. gx_step_desc.region_poses moves
   what a region holds. Arrays are copied. Replaces the regions held before; region_count 0 releases all. On an error
   the earlier regions stay held.
   Errors: ARGUMENT, NOT_FINITE, RANGE, INDEX, NOT_CLOSED, EMPTY (a region holds no copy; later cuts may leave it none),
   LIMIT, MEMORY; failure.index: region. */
GXFEM_API gx_result gx_body_hold(gx_body *body, const gx_region *regions, size_t region_count,
                                 gx_failure *failure /* or NULL */);

/* Rigid bodies of the caller's that pieces press on while contact is on (gx_body_contact) */
enum {
    GX_COLLIDER_PLANE = 0, /* what is below z = 0 */
    GX_COLLIDER_SPHERE,    /* size[0]: radius */
    GX_COLLIDER_CAPSULE,   /* size[0]: radius; size[1]: half the length of its axis, which is along z */
    GX_COLLIDER_BOX,       /* size: half the length of its edges along each axis */
    GX_COLLIDER_DISTANCE   /* distance() says where it is; size[0]: its smallest radius, for samples; 0: not known */
};
/* Signed distance of a point from the surface of a collider, m, below 0 inside, in the collider's own frame; normal:
   receives its gradient there, outward, of any length but 0. Never larger than the true distance. Called on the thread
   of the step. */
typedef double (*gx_distance_fn)(void *user, const double position[3], double normal[3]);
/* x = R X + o takes its own frame to space. Within a step o moves with velocity, and the body turns about it. */
typedef struct gx_collider {
    uint32_t id;   /* its name from step to step, below UINT32_MAX, each once */
    uint32_t kind; /* GX_COLLIDER_ */
    double size[3];
    double pose[12];         /* at the step's start: three rows of R o, R a rotation */
    double velocity[3];      /* of o, m/s */
    double spin[3];          /* rad/s, in space */
    double friction;         /* Coulomb's coefficient, 0 or more */
    gx_distance_fn distance; /* GX_COLLIDER_DISTANCE only */
    void *user;
} gx_collider;
/* What a collider feels at the end of a step */
typedef struct gx_collider_load {
    double force[3];  /* N: minus the sum of all that it does to the body */
    double torque[3]; /* N m, about its o at the step's end */
    /* by rows: how force and torque resist a translation (the first three) and a turn about o. Of the contacts alone:
       the body gives way, too */
    double stiffness[36];
    uint32_t contacts; /* places that press */
} gx_collider_load;

/* A time step. Zero but for dt: implicit Euler, one Newton iteration, nothing but inertia and elasticity. Arrays are by
   copy, as in gx_view. Points, forces and targets name copies: they have the epoch of the view, skin or hit that they
   come from, and are refused (GX_ERROR_STALE) after a cut that began another one. Anchors in their place are good after
   any cut; one that has lost its material does nothing, and the force of its spring or pair is 0 (see
   gx_body_lost_anchors). */
typedef struct gx_step_desc {
    double dt;         /* s, above 0; GXS_STATIC: 0 or more */
    double gravity[3]; /* m/s2 */
    /* GXS_BDF1 damps what swings: at dt = 1/60 s half of a free swing is gone after 5 s. GXS_BDF2 keeps it. */
    gxs_integrator integrator;
    uint32_t substeps;          /* GXS_EXPLICIT only: that many of dt; 0: as few as are cheap */
    uint32_t quick;             /* above 0: quick steps of so many iterations, 2 or 3, say (see gxs_step_desc) */
    uint32_t newton_iterations; /* at most; 0: 1, but as many as thin sheets need where copies are affine */
    double newton_tolerance;    /* stop at this residual (see gxs_step_report); 0: 1e-8 */
    uint32_t cg_iterations;     /* per Newton iteration, at most; 0: 1000 */
    double cg_tolerance;        /* reduction by each linear solve, below 1; 0: 1e-2; 1e-3 with GXS_MIDPOINT */
    double mass_damping;        /* Rayleigh's alpha, 1/s, 0 or more */
    const double *forces;       /* copy_count x 3, N; NULL: none */
    /* copy_count x 3: displacement of held copies at the step's end; others are not read. NULL: held copies stay */
    const double *targets;
    /* Twelve for each region that is held, or NULL: the three rows of A b, which put what the region holds at A X + b
       at the step's end, X in material coordinates. They go before targets. Twelve zeros: the region has no pose, and
       its copies have their targets or stay */
    const double *region_poses;
    uint64_t epoch;            /* of forces and targets; read if one of them is given */
    const gxs_spring *springs; /* spring_count */
    size_t spring_count;
    const gx_anchor *spring_anchors; /* spring_count: in place of each spring's point, which is not read; or NULL */
    double *spring_forces;           /* spring_count x 3: receives the force of each spring on the body, N; or NULL */
    const gxs_point *points; /* point_count: of contact. planes and contact() act on these and on nothing else */
    size_t point_count;
    const gx_anchor *point_anchors; /* point_count: in place of points, which is not read; or NULL */
    const gx_anchor *force_anchors; /* force_count */
    const double *anchor_forces;    /* force_count x 3, N: on force_anchors, beside forces */
    size_t force_count;
    const gxs_plane *planes; /* plane_count; without points they stop nothing */
    size_t plane_count;
    gxs_contact_fn contact; /* energy of a contact point; NULL: none */
    void *contact_user;
    /* pair_count: pieces, or parts of one, that press on each other (see gxs_pair). The caller finds them */
    const gxs_pair *pairs;
    size_t pair_count;
    /* pair_count x 2: the side that a normal points to, then the other; in place of points, not read then; or NULL */
    const gx_anchor *pair_anchors;
    /* pair_count x 3, m: read and written, see gxs_step_desc; those of lost anchors stay. NULL: friction creeps */
    double *pair_slips;
    double *pair_forces;          /* pair_count x 3: receives the force on the first side, N; or NULL */
    const gx_collider *colliders; /* collider_count: see gx_body_contact */
    size_t collider_count;
    gx_collider_load *collider_loads; /* collider_count: receives what each of them feels; or NULL */
    /* Which pieces touch, by gx_view's fragments: 0: these two do not; NULL: all do. other is UINT32_MAX: a collider of
       that id. It must answer the same for both orders of two pieces, and within a step */
    int (*contact_filter)(void *user, uint32_t fragment, uint32_t other, uint32_t collider);
    void *contact_filter_user;
    double sleep_speed;          /* m/s: slower fragments fall asleep (see gxs_step_desc); 0: none */
    double sleep_time;           /* s, for how long they must be slower; 0: 0.5 */
    double (*clock)(void *user); /* s; NULL: the body's */
    void *clock_user;
    double budget_seconds; /* no iteration begins after this time; 0: no limit. Needs a clock */
    /* above 0: the error of the motion asked for, as a share of it, .03 say, in place of integrator, substeps, quick
       and the numbers of Newton's method and CG: the step is divided as the motion demands (see gxs_step_desc) */
    double quality;
} gx_step_desc;
typedef gxs_step_report gx_step_report;
/* Takes one time step (GXFEM Eq. 10). On an error the body is as it was.
   A cut wakes the fragments that it touches. Copies that only slivers carry would be held by next to nothing, so they
   follow others (RXFEM Eq. 22; gx_body_desc.support_below): each takes the increment of the displacement field of the
   nearest element without such copies. A fragment without such an element is thin everywhere; its parts are then
   compared with its fullest part. It moves as a point if that part is smaller than support_below of its element.
   Where support_below is 0, it moves as a point if that part is smaller than 1e-9 or if no part reaches a tenth as far
   as its element.
   An affine copy that follows takes its A from that field too. A point with affine copies
   is moved as the material at its position at rest is. forces act on displacements alone, anchor_forces on A too;
   targets leave A as it is, poses turn it. Thin sheets that are flung turn far in a step, and one Newton iteration lags
   by half of the motion: newton_iterations 0 then takes two to forty, until the motion is within 5 %. Pairs without
   anchors are refused where copies are affine.
   failure.index: a spring, point, plane, pair, anchor, region or copy. The fields "displacement" and "velocity" are
   those of gx_view. Errors: ARGUMENT, NOT_FINITE, INDEX, LIMIT, MEMORY, STALE (copies of another epoch), RANGE (a
   number is too large or too small; as for FLAT, an element if field is NULL), FLAT (an element, see gx_body_model),
   DIVERGED, FREE (GXS_STATIC; a copy of a component that nothing holds). */
GXFEM_API gx_result gx_body_step(gx_body *body, const gx_step_desc *desc, gx_step_report *report /* or NULL */,
                                 gx_failure *failure /* or NULL */);

/* Gives the solver's model of the body as it is cut now, for other solvers. Affine copies have hidden vectors behind
   all copies, three for each: see gxs_model.affine. Arrays are the body's, valid until its next cut, hold, step or
   restore. Errors: ARGUMENT, LIMIT, MEMORY; RANGE, FLAT: an element's gradients are beyond doubles (index: element). */
GXFEM_API gx_result gx_body_model(gx_body *body, gxs_model *model, gx_failure *failure /* or NULL */);

/* >>touching: pieces that press on each other ---------------------------------------------------------------------- */

/* Contact of the body's pieces with each other, and of a piece with itself: lips of a cut, folds. Each step looks for
   vertices of the surface that are in front of, or a little behind, a facet that faces them, and joins the two by a
   pair (see gxs_pair) of stiffness c E A / (2 h): A is the vertex's share of the surface, h the size of its element, E
   the smaller of the two moduli. A closed cut then carries load like a layer of thickness h / c. Nothing is pushed at
   once: pieces that overlap when contact begins, or that are found late, press as they did before, and come apart at
   the speed `recovery`. What a piece pressed with, and the slip of its friction, stay with the material through cuts.
   A piece's own thickness is no contact: a facet is left out if it was near at rest and the vertex did not face it
   then, or was behind it.
   Pieces press on the caller's rigid bodies as well: see gx_step_desc.colliders. Samples are the vertices of the
   surface; facets on which the distance from a collider bends have more of them. Each is joined to the tangent plane of
   the collider there, by c E A / h. A collider that is inside a piece is seen at any depth. */
typedef struct gx_contact_desc {
    double stiffness;      /* c; 0: 10. Iterations of a step grow with its root */
    double friction;       /* Coulomb's coefficient, 0 or more */
    double sticking_speed; /* m/s; 0: 1e-3 */
    double recovery;       /* m/s: of pieces that overlap; 0: two elements' sizes each second */
    double depth;          /* overlap up to which it is seen, in sizes of an element; 0: 0.5 */
    uint32_t max_pairs;    /* of a step, which is refused beyond: GX_ERROR_LIMIT; 0: no limit but memory */
} gx_contact_desc;
/* Switches contact on for later steps, or off (NULL). It forgets the slips of friction. Steps with contact refuse
   GXS_MIDPOINT ("integrator") and "quality". Contact is saved, cloned and restored with what presses and sticks.
   Errors: ARGUMENT, NOT_FINITE. */
GXFEM_API gx_result gx_body_contact(gx_body *body, const gx_contact_desc *desc /* or NULL: off */,
                                    gx_failure *failure /* or NULL */);

/* A place where a piece pressed on another one, or on itself, at the end of the last step */
typedef struct gx_contact {
    uint32_t fragment, other; /* below gx_view.fragment_count; equal: of one piece; other is UINT32_MAX: a collider */
    uint32_t collider;        /* its id; UINT32_MAX: it is a piece */
    double position[3];       /* on the surface of fragment, in space, m */
    double normal[3];         /* from other to fragment, of length 1 */
    double force[3];          /* on fragment, N */
    double depth;             /* of the position in other, m; below 0: in front of it */
} gx_contact;
/* Lists them. contacts: room for capacity. *count: how many there are, also after CAPACITY; 0 before the first step and
   after a step that failed.
   Errors: ARGUMENT, CAPACITY (capacity is below *count), SEQUENCE (contact is off, or a cut has been since the step).
 */
GXFEM_API gx_result gx_body_contacts(const gx_body *body, gx_contact *contacts, size_t capacity, size_t *count,
                                     gx_failure *failure /* or NULL */);

enum {                       /* of gx_contact_event.change */
       GX_CONTACT_BEGAN = 0, /* since the last call */
       GX_CONTACT_PERSISTS,
       GX_CONTACT_ENDED /* also where a fragment has got another id or is no more */
};

/* Two fragments that pressed on each other at the end of the last step, or a fragment and a collider, or one with
   itself: all their contacts together */
typedef struct gx_contact_event {
    uint32_t change;          /* GX_CONTACT_ */
    uint32_t fragment, other; /* ids, see gx_view.fragment_id: the lower one first; other is 0: a collider */
    uint32_t collider;        /* its id; UINT32_MAX: none */
    uint32_t contacts;        /* how many of gx_contact they are; 0, as all below: it has ended */
    double force[3];          /* on fragment, N; 0 where one presses on itself */
    double load;              /* N: sum of the contacts' normal forces */
    double position[3];       /* m: mean of theirs, by normal force */
    double normal[3];         /* their mean, by normal force, to fragment, of length 1; 0 where they cancel */
} gx_contact_event;
/* What touches now, beside what touched at the last call: for sounds, for what breaks. Ascending by fragment, other,
   collider. *count: how many there are, also after CAPACITY, which leaves what is known of the last call as it was.
   gx_body_view must have been called after the last cut, since it gives new fragments their ids.
   Errors: ARGUMENT, CAPACITY (capacity is below *count), MEMORY, SEQUENCE (contact is off; a cut has been since the
   step; gx_body_view). */
GXFEM_API gx_result gx_body_contact_events(gx_body *body, gx_contact_event *events, size_t capacity, size_t *count,
                                           gx_failure *failure /* or NULL */);

/* >>drawing -------------------------------------------------------------------------------------------------------- */

typedef struct gx_skin_desc {
    /* The outer surface is shaded smooth across mesh edges that bend by less, rad. 0: each face is flat. */
    double crease_angle;
    /* 1: faces of a cut are shaded smooth across the edges of its triangles. 0: each of its planes is flat. */
    int smooth_cuts;
} gx_skin_desc;

enum { GX_SKIN_OUTER = 0 };
#define GX_SKIN_SEVERED UINT32_MAX

typedef struct gx_range {
    uint32_t first, count;
} gx_range;

/* The visual surface: the outer surface and both faces of every cut that has separated material. The arrays are the
   body's, valid until the next cut, restore or gx_body_skin. A vertex is a point of one fragment with one normal: at
   creases and along cuts there are several at one point. */
typedef struct gx_skin {
    size_t vertex_count;
    uint32_t vertex_width;         /* copies for which a vertex has room */
    const uint32_t *vertex_copies; /* vertex_count x vertex_width: copies that move it; those of weight 0 stand last */
    /* vertex_count x vertex_width: x = X + sum of weight u over the copies; where copies are affine, see
       gx_view.copy_affine, plus weight A (X - X_i) */
    const double *vertex_weights;
    /* vertex_count: a name, equal for vertices at the same material point, exactly. Vertices whose copies of weight not
       0 are equal too are one corner of the surface: with corners merged like this it is watertight. */
    const uint32_t *vertex_point;
    const double *vertex_rest;   /* vertex_count x 3, material coordinates, m */
    const float *vertex_normal;  /* vertex_count x 3, outward, of length 1, at rest */
    const float *vertex_texture; /* vertex_count x 2 */
    size_t triangle_count;
    const uint32_t *triangles;         /* triangle_count x 3, counter-clockwise from outside */
    const uint32_t *triangle_fragment; /* triangle_count */
    const uint32_t *triangle_element;  /* triangle_count */
    const uint32_t *triangle_material; /* triangle_count, that of the cell (gx_view.cell_material) */
    /* triangle_count: GX_SKIN_OUTER; 1 + n: face of the n-th surface that cut the body, counted over all its cuts (the
       first, if several coincide); GX_SKIN_SEVERED: a severed link */
    const uint32_t *triangle_surface;
    /* Vertices and triangles that differ from those of the call before, ascending. vertex_count and triangle_count may
       differ too. triangle_fragment may differ outside of the ranges. */
    const gx_range *vertex_ranges;
    size_t vertex_range_count;
    const gx_range *triangle_ranges;
    size_t triangle_range_count;
    uint64_t epoch; /* of the numbering of copies, as in gx_view: for gxs_point */
} gx_skin;
/* A vertex of the skin as a point, for springs and contact. Keep the skin as long: the point may refer to it. vertex:
   below vertex_count */
GXFEM_API gxs_point gx_skin_point(const gx_skin *skin, uint32_t vertex);
/* Makes the skin, or brings it up to date where cuts have been since the last call. Another description makes all of it
   anew. Errors: ARGUMENT, NOT_FINITE, MEMORY, LIMIT. */
GXFEM_API gx_result gx_body_skin(gx_body *body, const gx_skin_desc *desc /* or NULL: zero */, gx_skin *skin,
                                 gx_failure *failure /* or NULL */);
/* Gives the deformed vertices of the last gx_body_skin, m. Errors: ARGUMENT, SEQUENCE (there is no skin, or a cut has
   been since). */
GXFEM_API gx_result gx_body_skin_positions(const gx_body *body, double *positions /* vertex_count x 3 */,
                                           gx_failure *failure /* or NULL */);
/* Gives the same less an origin, and normals, for drawing. Normals of the outer surface are interpolated from those at
   nodes; these are means over the faces of the fragment around the node, weighted by area. Errors: as above, NOT_FINITE
   (origin). */
GXFEM_API gx_result gx_body_skin_vertices(gx_body *body, const double origin[3] /* or NULL: 0 */,
                                          float *positions /* vertex_count x 3, or NULL */,
                                          float *normals /* vertex_count x 3, of length 1, or NULL */,
                                          gx_failure *failure /* or NULL */);

#define GX_HIT_COPIES 16 /* room for the copies of a hit */

/* A point of the deformed body: where a ray first meets the skin (gx_body_pick), or the material at or nearest to a
   point of space (gx_body_locate). gx_hit_point makes a point of it, to which a spring can be attached. */
typedef struct gx_hit {
    /* Of the skin. UINT32_MAX: the ray meets nothing, and the rest is 0; or a located point, which has none */
    uint32_t triangle;
    uint32_t fragment, element;
    uint32_t surface;    /* of the triangle; of a located point: 0 */
    uint32_t cell;       /* below gx_view.cell_count */
    uint32_t slot;       /* names the cell also after further cuts, see gx_body_place */
    uint32_t slot_count; /* gx_view.slot_count then: what is divided off the cell later has a slot from there on */
    /* of a ray: in lengths of direction. Of a located point: m, from the point of space; 0: that is in the cell */
    double distance;
    double position[3], material[3]; /* deformed, m; material coordinates, m */
    uint32_t copy_count;             /* of the copies that move the point */
    uint32_t copies[GX_HIT_COPIES];  /* copy_count */
    double weights[GX_HIT_COPIES];   /* copy_count, above 0, 1 in sum */
    uint64_t epoch;                  /* of the numbering of copies, as in gx_view: for gxs_point */
} gx_hit;
/* The point of a hit, for springs and contact. Keep the hit as long: the point may refer to it. If the ray met nothing,
   the point has count 0, which steps refuse. */
GXFEM_API gxs_point gx_hit_point(const gx_hit *hit);
/* Makes an anchor of a hit. Its position is exactly in the cell that was hit, or in what cuts have left of it since:
   the hit's material point, or, where rounding or a cut has put that beside it, the nearest point found on the way into
   it. So it is on the hit's side of all cuts, also of those that end in the body. Errors: ARGUMENT, EMPTY (the ray met
   nothing, or the cell was removed), STALE (a cut has begun another epoch since the hit), INDEX, NOT_FINITE, RANGE,
   FLAT (the cell is too thin for points given by doubles), MEMORY, LIMIT. */
GXFEM_API gx_result gx_hit_anchor(gx_body *body, const gx_hit *hit, gx_anchor *anchor,
                                  gx_failure *failure /* or NULL */);
/* Finds the nearest triangle on a ray, the first of equally near ones. Takes a pass over the copies, then no more than
   the ray meets. Errors: ARGUMENT (also: direction is 0), NOT_FINITE, SEQUENCE (there is no skin, or a cut has been
   since), MEMORY, LIMIT. */
GXFEM_API gx_result gx_body_pick(gx_body *body, const double origin[3], const double direction[3], gx_hit *hit,
                                 gx_failure *failure /* or NULL */);

/* >>locating ------------------------------------------------------------------------------------------------------- */

/* A cell of an uncut element fills its deformed element. A cell of a cut one fills the part that is its own. Corners
   are where rest + displacement, rounded once, puts them; which cells contain a point is decided exactly by that. Faces
   and walls belong to the cells on both their sides. Inverted elements contain points as others do, flat ones none.
   Cells with affine copies (gx_body_desc.affine_below) have curved faces: points are pulled back to rounding, and lie
   where that puts them; the surface that is nearest has flat triangles between its vertices, as the skin has. */

/* Finds the material at points of space: of the cells that contain a point the one with the lowest slot. hit.material
   is within 2^-48 of the element's size of the exact place, and hit.position is the point. Where no cell contains it,
   the nearest point of the body's surface: distance is above 0. The first call makes a tree of boxes; each takes a pass
   over the copies, and the first after a cut lists the cells. Many points are faster in one call than in many.
   points: count x 3, m, in space. hits: room for count. After an error hits mean nothing.
   Errors: ARGUMENT, NOT_FINITE (a point, or a copy's displacement), RANGE (likewise: 2^128 or more), EMPTY (all
   material is removed), LIMIT, MEMORY. */
GXFEM_API gx_result gx_body_locate(gx_body *body, const double *points, size_t count, gx_hit *hits,
                                   gx_failure *failure /* or NULL */);
/* Finds all cells that contain a point, by slot: several where pieces overlap, and on faces and walls. *count: how many
   there are, also after CAPACITY; 0 is no error. Errors: as above, CAPACITY (capacity is below *count). */
GXFEM_API gx_result gx_body_locate_all(gx_body *body, const double point[3], gx_hit *hits, size_t capacity,
                                       size_t *count, gx_failure *failure /* or NULL */);
/* Gives where a cell has a material point; outside of its element, where its map, extended, would have it. slot:
   of a hit, below gx_view.slot_count. It names a cell for good; where a cut divides the cell, one part keeps it.
   Errors: ARGUMENT, NOT_FINITE (material, or a copy's displacement), RANGE (likewise), INDEX (slot), EMPTY (slot: the
   cell was removed). */
GXFEM_API gx_result gx_body_place(const gx_body *body, uint32_t slot, const double material[3], double position[3],
                                  gx_failure *failure /* or NULL */);
/* >>slicing: where a blade is, while the body moves --------------------------------------------------------------- */

/* A blade is an edge in space, a polyline, that is moved through a body, which moves meanwhile. Each piece is cut where
   it meets the edge: pieces that lie over each other in space are different layers, and each remembers, in material
   coordinates, how far the edge has come in it (its front). A move cuts what lies between the fronts and the edge when
   a front has advanced far enough, or before its path bends away from a straight strip. A partly cut element has no
   mechanical effect, so that waiting costs nothing. The path is known to a tolerance, so that pieces of less than a
   thousandth of an element are not meant, nor are sheets that are thinner than the tolerance: they stay with the
   material beside them. */
typedef struct gx_blade gx_blade; /* opaque; belongs to a body, which destroys it at last */

typedef struct gx_blade_desc {
    /* m: a strip begins anew where the edge's path in the material bends by more. 0: a hundredth of the mean size of
       elements, which is the cube root of six times their volume */
    double tolerance;
    double min_advance;   /* m: a front that has come less far waits. 0: half the mean size of elements */
    uint32_t max_samples; /* places at which a layer looks at the edge, at most; 0: 1000 */
    int starts_inside;    /* 1: the first edge, and the first after a lift, may be in the material */
} gx_blade_desc;
typedef struct gx_blade_report {
    size_t layer_count;    /* pieces near the edge */
    size_t triangle_count; /* of the strips that cut */
    double deviation;      /* m: the largest distance between the edge's path and these strips, as far as it was seen */
    gx_cut_report cut;     /* zero, with min_link_ratio 1, where nothing was cut */
} gx_blade_report;
/* Creates a blade. Errors: ARGUMENT, NOT_FINITE, MEMORY, CONFIGURATION. */
GXFEM_API gx_result gx_blade_create(gx_body *body, const gx_blade_desc *desc /* or NULL: zero */, gx_blade **blade,
                                    gx_failure *failure /* or NULL */);
GXFEM_API void gx_blade_destroy(gx_blade *blade); /* or NULL */
/* The body's blades in the order in which they were created, to find those of a loaded or cloned body; NULL where there
   are no more. After gx_body_restore the body has the blades of the other: those with the same index stay valid, those
   that the other lacks are lifted. */
GXFEM_API gx_blade *gx_body_blade(const gx_body *body, size_t index);
/* Moves the edge and cuts what it has passed since the last move, relative to the material. A long move goes in steps
   of an element, 8 for each element of the body's length at most. A move that changes little is remembered and worked
   out later, before the path bends. edge: point_count x 3, in space, m; as many points at
   each move until the blade is lifted, 2 or more; ends may be 10^12 elements away. scope: fragments that alone are cut,
   below gx_view.fragment_count; count 0: all. On an error body and blade are as they were. Errors: ARGUMENT (also:
   the first edge is inside the material and starts_inside is 0, index: point), INDEX, NOT_FINITE and RANGE (edge, or
   "displacement", index: copy), LIMIT, MEMORY. */
GXFEM_API gx_result gx_blade_move(gx_blade *blade, const double *edge, size_t point_count,
                                  const uint32_t *scope_fragments, size_t scope_fragment_count,
                                  gx_blade_report *report /* or NULL */, gx_failure *failure /* or NULL */);
/* Cuts what waits, and forgets fronts and edge: the next move begins anew. Errors: ARGUMENT, NOT_FINITE and RANGE
   ("displacement", index: copy), LIMIT, MEMORY. */
GXFEM_API gx_result gx_blade_lift(gx_blade *blade, gx_blade_report *report /* or NULL */,
                                  gx_failure *failure /* or NULL */);

/* A place of a blade's edge that is in the material: to push it, to make a sound, for the hand that holds the blade */
typedef struct gx_blade_contact {
    gx_hit hit;    /* the material there; position: the place; distance: 0 */
    double along;  /* where on the edge: index of a point, + share of the way to the next */
    double length; /* m: how much of the edge it stands for, half of that on each side of it */
} gx_blade_contact;
/* Finds what of the edge, where the last move left it, is in the body as it is now, which may have moved since. Nothing
   of body or blade changes. Contacts of a piece are evenly spaced, about half an element apart, and come in the order
   along the edge; their lengths add up to the length in that piece. Where pieces overlap each has its own contacts, and
   where the edge lies in a wall the pieces on both sides have. contacts: room for capacity; after an error they mean
   nothing. *count: how many there are, also after CAPACITY; 0 while the blade is lifted.
   Errors: ARGUMENT, NOT_FINITE (a copy's displacement), RANGE (likewise: 2^128 or more), CAPACITY (capacity is below
   *count), LIMIT, MEMORY. */
GXFEM_API gx_result gx_blade_contacts(gx_blade *blade, gx_blade_contact *contacts, size_t capacity, size_t *count,
                                      gx_failure *failure /* or NULL */);

/* Removes the material that a closed tool in space covers now (a drill, a punch), from each piece where it meets the
   tool. tool: vertices in space, m; kind and scope_slots are not read. Its triangles are divided where elements
   are smaller.
   Errors: as gx_body_cut; a field of the tool reads "tool.vertices"; NOT_FINITE and RANGE also of "displacement"
   (index: copy). */
GXFEM_API gx_result gx_body_carve(gx_body *body, const gx_surface *tool, gx_cut_report *report /* or NULL */,
                                  gx_failure *failure /* or NULL */);

/* >>hashing -------------------------------------------------------------------------------------------------------- */

/* Hash of the cells and copies, the same on every compiler. 0 after an error: ARGUMENT, MEMORY, LIMIT. */
GXFEM_API uint64_t gx_body_topology_hash(gx_body *body, gx_failure *failure /* or NULL */);
/* Hash of all that a failed call must leave as it was, and of the fragments' ids */
GXFEM_API uint64_t gx_body_state_hash(const gx_body *body);
/* The cause in words. With a gx_failure:
   fprintf(stderr, "%s: %s\n", failure.field ? failure.field : "the call", gx_result_text(failure.result));
   examples/gxfailure.h adds the index and the surface. */
GXFEM_API const char *gx_result_text(gx_result result);

/* >>saving --------------------------------------------------------------------------------------------------------- */

/* A body as bytes or as another body, with all that it is: mesh, materials, cuts, displacement, velocity, rest times,
   the history of BDF2, held regions, contact, ids of fragments and their changes. Further cuts give the same cells, and
   further steps the same bits in the same program. For that, saving, cloning and restoring make the solvers of all
   bodies concerned start anew: the next step makes its preconditioner and takes no guess from the last. Sleeping copies
   go on sleeping. Pointers are not saved. */

/* Writes the body to memory, which has room for capacity bytes. *size: receives how many bytes it takes, also after
   CAPACITY. memory NULL: computes *size only. Fields have fixed widths, in the machine's byte order, which the bytes
   tell. Errors: ARGUMENT, CAPACITY (capacity is below *size); with contact MEMORY, LIMIT. */
GXFEM_API gx_result gx_body_save(gx_body *body, void *memory, size_t capacity, size_t *size,
                                 gx_failure *failure /* or NULL */);
/* Reads a body. Bytes from anywhere do no harm: a checksum detects accidental damage, and everything that a body relies
   on is checked. Of desc (NULL: all zero) it takes allocator, clock and jobs, and, for each saved material of kind
   GXS_CUSTOM, energy and user of the material with its index.
   Errors: ARGUMENT (index: a material without its energy), MEMORY, LIMIT (also: one edge, face or element divided
   10,000 times in a row), FORMAT, DAMAGED (index: bytes read until then), CONFIGURATION. */
GXFEM_API gx_result gx_body_load(const void *memory, size_t size, const gx_body_desc *desc, gx_body **body,
                                 gx_failure *failure /* or NULL */);
/* Makes another body of the same state, with the same allocator, clock, jobs and energies. Errors: ARGUMENT, MEMORY,
   LIMIT, CONFIGURATION. */
GXFEM_API gx_result gx_body_clone(gx_body *body, gx_body **clone, gx_failure *failure /* or NULL */);
/* The body becomes what `from` is: to go back to a clone, or to bring a clone up to date. If both have been cut alike,
   only the state is copied, and neither cells nor the solver's model are made anew. Otherwise the arrays of views and
   skins become invalid, as by a cut. Allocator, clock and jobs stay the body's own. On an error the body is as it was.
   Errors: ARGUMENT, MEMORY, LIMIT, CONFIGURATION. */
GXFEM_API gx_result gx_body_restore(gx_body *body, gx_body *from, gx_failure *failure /* or NULL */);

#ifdef __cplusplus
}
#endif
#endif /* GXFEM_H: stop here for the interface */

#if defined(GXFEM_IMPLEMENTATION) && !defined(GXFEM_IMPLEMENTED)
#define GXFEM_IMPLEMENTED
#include "gxfem_boolean.h"
#include "gxfem_integrate.h"
#include "gxfem_solve.h" /* again: now with its implementation */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef GXFEM_SCALAR
#pragma clang attribute push(__attribute__((target("no-simd128"))), apply_to = function)
#endif

/* COLD functions are seldom called: kept out of line and compiled for size. APART: out of line, so that their arrays
   are not in the frame of what calls them. */
#if defined(__GNUC__) || defined(__clang__)
#define GXP_COLD              __attribute__((cold, noinline))
#define GXP_APART             __attribute__((noinline))
#define GXP_PREFETCH(address) __builtin_prefetch(address)
#define GXP_PREFETCHES                                                                                                 \
    static inline __attribute__((always_inline)) /* without it gcc takes such a function for pure and drops calls */
#else
#define GXP_COLD
#if defined(_MSC_VER)
#define GXP_APART __declspec(noinline)
#else
#define GXP_APART
#endif
#define GXP_PREFETCH(address) ((void)(address))
#define GXP_PREFETCHES        static inline
#endif

/* >>state: the body, divided by how long its parts live ------------------------------------------------------------ */

/* The types of what a body owns: settings and mesh, from creation to destruction; cells, leaves, copies and records of
   surfaces, made by cuts; the undo log of a cut; caches. No function is here. */

#define GXP_NONE UINT32_MAX
/* Shares of an element, where gx_body_desc.support_below is 0. Copies that no part above GXP_SUPPORT carries follow
   others. Fragments without a part above GXP_SPECK move as points. */
#define GXP_SUPPORT 1e-3
#define GXP_SPECK   1e-9

/* Where support_below is 0, a fragment that reaches less far within every element moves as a point: its copies would
   move ten times as far as its material. */
#define GXP_SPECK_REACH 0.1

typedef struct gxp_words { /* growing array of indices */
    uint32_t *data, count, capacity;
} gxp_words;
typedef struct gxp_keys { /* growing array of pairs of indices, the first << 32 */
    uint64_t *data;
    uint32_t count, capacity;
} gxp_keys;

/* --- from creation to destruction: the caller's settings, the mesh --- */

typedef struct gxp_config {
    gx_allocator allocator;
    gx_jobs jobs;
    double (*clock)(void *user);
    void *clock_user;
    double support_below;                          /* as given */
    double follow_below, speck_below, speck_reach; /* see >>supports */
    double affine_below;                           /* see >>sheets */
} gxp_config;

typedef struct gxp_box { /* tree node; count 0: children first, first+1 */
    double low[3], high[3];
    uint32_t first, count;
} gxp_box;

/* Arrays are made at the creation and do not change. The complex has the elements' nodes, faces and edges. */
typedef struct gxp_mesh {
    uint32_t node_count, node_capacity[4];
    double *positions;    /* node_count x 3 */
    uint32_t *node_start; /* node_count + 1, into node_elements */
    /* node_count: GXP_NODE_PINCHED, GXP_EDGE_PINCHED */
    uint8_t *node_pinched;
    float *texture; /* node_count x 2, or NULL */
    uint32_t element_count, element_capacity[5];
    uint32_t *node_elements; /* element_count x 4: elements around each node */
    gxp_box *boxes;
    uint32_t *box_elements;      /* element_count, in tree order */
    uint32_t *element_materials; /* element_count */
    double *sizes;               /* element_count: cube roots of six times the volumes, m; NULL: no blade has asked */
    double mean_size, largest_size;
    double affine_length; /* m, about an element's size; 0 where affine_below is 0 */
    uint32_t box_count;
    uint32_t edge_count, edge_capacity[1];
    uint8_t *edge_pinched; /* edge_count: elements around it meet in the edge only */
    uint32_t material_count, material_capacity[1];
    gx_material *materials;
} gxp_mesh;
enum {
    GXP_NODE_PINCHED = 1, /* elements around the node are not joined by faces */
    GXP_EDGE_PINCHED = 2  /* one of its edges is pinched */
};

/* --- made by cuts: cells, leaves, copies, records of surfaces; held regions --- */

typedef struct gxp_cell { /* without gaps between its members: rows are saved as bytes */
    uint32_t element;
    uint32_t copies[4];
    uint32_t first_leaf; /* list through gxp_leaf.next; GXP_NONE: removed */
    uint32_t next;       /* next cell of the element, GXP_NONE: last */
    uint32_t kept : 1;
    uint32_t material : 31;
    double volume;   /* m3 */
    double mass[10]; /* kg, order of gxs_element.mass */
} gxp_cell;

/* Rows 0 ... element_count-1 are the elements' first cells. Others go some time after they are removed: see >>settle */
typedef struct gxp_cells {
    uint32_t count, capacity[5];
    gxp_cell *data;
    uint32_t *slot;      /* its name, ascending */
    uint32_t *stamp;     /* scratch.stamp of the last walk that met the cell */
    uint32_t *saved_by;  /* undo.cut_number of the last cut that saved or made it */
    uint32_t *new_index; /* its index in scratch.new_cells, if it is there */
} gxp_cells;

typedef struct gxp_slots { /* all that there have been */
    uint32_t count, capacity[1];
    uint32_t *parent; /* the slot from which it was divided; of a first cell: its own */
} gxp_slots;

typedef struct gxp_leaf {
    uint32_t cell, next; /* next of the cell, GXP_NONE: last, or removed */
} gxp_leaf;

typedef struct gxp_leaf_mark {
    uint32_t stamp;  /* scratch.stamp of the last walk that met the leaf */
    int32_t winding; /* in a walk of >>solids: the winding number around it */
} gxp_leaf_mark;

typedef struct gxp_leaves { /* beside the leaves of the complex */
    uint32_t count, capacity[2];
    gxp_leaf *data;
    gxp_leaf_mark *mark;
} gxp_leaves;

typedef struct gxp_copies {
    uint32_t count, capacity[19];
    uint32_t *node;
    double *displacement, *velocity; /* x 3 */
    double *rest_time;               /* s */
    uint8_t *held;                   /* 1: by a region */
    uint32_t *label;                 /* 2 x index of its fragment at the last snapshot, + 1: cut since */
    uint32_t *before; /* 2 x its index when the solver's model was made; of a newer copy: 2 x that of its origin, + 1 */
    /* displacement and velocity a step ago, x 3, and room for those of now; from the first BDF2 step on */
    double *history[4];
    double *seen;       /* displacement when the tree was last refitted, x 3; from the first use of the tree on */
    double *struck;     /* displacement at the last move of the blade that may leave out moves, x 3 */
    double previous_dt; /* s, of the step that history[0] and [1] are from; 0: there is none */
    /* There where affine_below is above 0: is the copy affine? The columns of its A and of A's rate, 0 if it is not;
       both a step ago, if history[0] and [1] are */
    uint8_t *affine;
    double *linear, *linear_rate, *linear_history[2]; /* x 9 */
    double *linear_seen;                              /* A when the tree was last refitted, as seen */
    int bends;                                        /* a copy is affine, or was when the flags were read */
} gxp_copies;

typedef struct gxp_surface_record {
    uint32_t label; /* of its first triangle */
    uint32_t map;   /* its first, GXP_NONE: it has no texture */
} gxp_surface_record;

typedef struct gxp_cuts { /* the surfaces that have cut the body */
    uint32_t label_count; /* triangles so far */
    uint32_t surface_count, surface_capacity[1];
    gxp_surface_record *surfaces;
    uint32_t map_count, map_capacity[1];
    /* x 8, for each triangle of surfaces with a texture: material coordinates less the complex's origin to texture
       coordinates, 3 factors and a constant, twice */
    double *maps;
    uint64_t hash;  /* of the mesh and of all cuts: bodies with the same one have the same cells and copies */
    uint64_t epoch; /* the hash when copies were created or removed last; 0: never */
} gxp_cuts;

typedef struct gxp_region { /* without gaps between its members: rows are saved as bytes */
    uint32_t kind, axis;
    int32_t side;
    uint32_t first_index, index_count;   /* in holds.indices: triangles x 3, nodes, or elements of anchors */
    uint32_t first_vertex, vertex_count; /* in holds.vertices: of a surface, or two of each anchor */
    uint32_t zero;
    double value, low[3], high[3], center[3], radius; /* see gx_region */
} gxp_region;

/* A closed surface in the complex while it is asked about, see >>grips */
typedef struct gxp_probe {
    const gxp_region *region; /* NULL: no transaction is open */
    gx_surface shell;
    double corners[24];      /* of a box */
    gxp_words points;        /* by vertex: in the complex, or GXP_NONE */
    gxb_triangle *triangles; /* by triangle; plane GXP_NONE: not in the complex yet */
    uint32_t triangle_capacity;
    gxp_words reached; /* by a triangle: leaves */
    gx_result result;  /* of noting these */
} gxp_probe;

typedef struct gxp_holds {
    uint32_t count, capacity[1];
    gxp_region *regions;
    uint32_t index_count, index_capacity[1], *indices;
    uint32_t vertex_count, vertex_capacity[1];
    double *vertices;     /* x 3 */
    int listed;           /* the next two are those of the regions */
    gxp_words node_first; /* count + 1, into nodes */
    gxp_words nodes;      /* in each region, ascending; none for anchors */
    int stale;            /* copies.held is older than the regions or the last cut */
    gxp_words region_of;  /* by copy: the region that holds it, or GXP_NONE */
    /* of a call */
    gxp_words near_nodes; /* that may be in a region */
    gxp_probe probe;
} gxp_holds;

/* --- the undo log of a cut --- */

typedef struct gxp_log { /* rows of a table as they were, without gaps: the columns that are undone */
    gxp_words rows;
    unsigned char *bytes;
    uint32_t byte_capacity, row_size;
} gxp_log;

enum { /* indices of gxp_tables */
       GXP_NODES,
       GXP_ELEMENTS,
       GXP_EDGES,
       GXP_MATERIALS,
       GXP_CELLS,
       GXP_SLOTS,
       GXP_LEAVES,
       GXP_COPIES,
       GXP_SURFACES,
       GXP_MAPS,
       GXP_REGIONS,
       GXP_REGION_INDICES,
       GXP_REGION_VERTICES,
       GXP_SNAPSHOT,
       GXP_REMOVED_IDS,
       GXP_VIEW,
       GXP_SUMS,
       GXP_SKIN_VERTICES,
       GXP_SKIN_TRIANGLES,
       GXP_TABLES
};

typedef struct gxp_undo {
    gxp_log cells, leaves; /* cells.rows: each cell that the cut changed, once */
    uint32_t cut_number;
    uint32_t counts[GXP_TABLES], labels, dirty, splits; /* when the cut began */
} gxp_undo;

/* --- caches: made anew from the above when they are stale --- */

typedef struct gxp_view { /* the body as gx_view tells it */
    int stale;            /* a cut has been since the lists were made */
    uint32_t count, capacity[7];
    uint32_t *cell, *slot, *fragment, *element, *copies; /* of each kept cell; copies x 4 */
    uint32_t *material;                                  /* likewise; NULL: the body has one only */
    double *volume;
    gxp_words indices;         /* by cell: the index of a kept one in these lists; empty until somebody asks */
    gxp_words copy_fragment;   /* of each copy: a parent among copies, see gxp_find; the root stands for its fragment */
    gxp_words fragment_number; /* of each root */
    /* copy_fragment and fragment_number hold for copies older than splits, and nothing has been removed */
    int labels_known;
    gxp_words splits;        /* copies made since then, each with the one it comes from */
    gxp_words split_cells;   /* of a call: cells around their nodes */
    gxp_words split_parents; /* of a call: of copies, see gxp_find */
    uint32_t fragment_count, sum_capacity[4];
    double *fragment_volume, *fragment_mass, *fragment_center, *fragment_inertia; /* x 1, 1, 3, 6 */
    double body_volume, body_mass;
    int sums_stale; /* the lists are newer than the sums */
} gxp_view;

/* The fragments when gx_body_view was called last. Changes of fragments are told by comparison with it. */
typedef struct gxp_snapshot {
    uint32_t count, capacity[3];
    uint32_t *id, *origin, *change;
    gxp_words removed; /* ids */
    uint32_t next_id;
    uint32_t stale; /* a cut has been since */
} gxp_snapshot;

/* Affine copies as the solver's model has them. Their hidden vectors stand behind all copies, three for each. */
typedef struct gxp_hidden {
    gxp_words copies; /* affine copies of the model, ascending. Those of specks are none: a speck moves as a point */
    gxp_words first;  /* vectors of the model: gxs_model.affine; empty if copies is */
    gxp_words before, origins; /* while the model is changed: first of the model before; gxs_change.origins */
    uint8_t *held;             /* vectors of the model */
    uint8_t *plain;            /* by copy, while the model is made: 1: part of a speck */
    uint32_t held_capacity, plain_capacity;
    double *state; /* of a step: displacement, velocity, both a step ago, x 3 and by vector, then rest times */
    uint32_t state_capacity;
    gxp_words span_copies; /* of a step: spans of its springs and points, one after the other */
    double *span_weights;
    uint32_t span_capacity;
} gxp_hidden;

/* The solver's model agrees with the body, or did before the last cuts, or must be made whole. */
typedef enum gxp_model_state { GXP_MODEL_KNOWN, GXP_MODEL_CHANGED, GXP_MODEL_STALE } gxp_model_state;

typedef struct gxp_model {
    gxp_model_state state;
    int empty;   /* it has no elements: the solver has not been given it */
    int updated; /* 1: it has been changed since it was set whole */
    /* hash of the state when the body was saved, copied or read; 0: it has stepped since then */
    uint64_t resumed;
    /* elements of which a cell or its copies have changed since the solver's model was made; some more than once */
    gxp_words changed;
    gxp_words thin; /* elements with a part of a share below follow_below, ascending; of use unless state is STALE */
    /* there only while the solver is told; it copies them */
    gxs_element *parts;
    uint32_t part_count, part_capacity;
    double *rest; /* copies, x 3: where they are at rest, m */
    uint32_t rest_capacity;
    gxs_material *elastic;
    uint32_t elastic_capacity;
    gxs_constraint *constraints;
    uint32_t constraint_count, constraint_capacity;
} gxp_model;

typedef struct gxp_attached { /* of a step: what it has at anchors and regions, by copies */
    gxs_spring *springs;
    gxs_point *points;
    gxs_pair *pairs;
    gxp_words sides; /* pairs x 2 x gxp_side_room: vectors of their two sides */
    double *weights; /* as many: of these vectors */
    double *forces;  /* copies x 3, N: all that are given */
    double *targets; /* copies x 3, m: of held copies */
    uint32_t spring_capacity, point_capacity, pair_capacity, weight_capacity, force_capacity, target_capacity;
} gxp_attached;

/* Material around a copy or cell: integrals over cells, without density, and over the elements they are in */
typedef struct gxp_bulk {
    double volume, first[3], second[6]; /* m3, m4, m5: of 1, x, x x^T, less the mesh's lower corner */
    double whole, shape[6];             /* of whole elements: volume, volume x covariance */
} gxp_bulk;

/* The key of a vertex of the skin: the name of a point of the complex, four names in ascending order, a group. On the
   outer surface the names are slots and the group is 0. On a face of a cut they are copies; the group is the surface
   and the side, or the surface, the plane and the side. */
typedef struct gxp_skin_key {
    uint32_t point, name[4], group[2];
} gxp_skin_key;
#define GXP_PLANE_GROUP 2u /* group[1] of plane 0, behind it */

typedef struct gxp_skin_vertex { /* beside the columns that users see */
    gxp_skin_key key;
    uint32_t slots[4]; /* whose sums make its normal, by its weights */
    uint32_t next;     /* of its bucket */
    uint32_t corner;   /* 3 x triangle + k: its first corner */
    uint8_t outer;     /* 1: of the outer surface */
    uint8_t placed;    /* 1: new in its place since the last update */
    uint8_t noted;     /* 1: in changed[0] */
} gxp_skin_vertex;

typedef struct gxp_skin_links {
    uint32_t slots[3];                           /* to which it adds its normal */
    float normal[3];                             /* of its facet, outward at rest, of length 1 */
    uint32_t next, previous;                     /* of its element */
    uint32_t corner_next[3], corner_previous[3]; /* of the same vertex */
} gxp_skin_links;

typedef struct gxp_skin_slot {
    uint32_t copy; /* GXP_NONE: belongs to one vertex */
    uint32_t group;
    uint32_t next; /* in its bucket, or free */
} gxp_skin_slot;

typedef struct gxp_skin {
    int made; /* 0: all of it is to be made */
    gx_skin_desc desc;
    gxp_words dirty; /* elements that cuts have touched since; some more than once */
    uint32_t vertex_count, vertex_capacity[7];
    gxp_skin_vertex *vertices;
    uint32_t *copies, *point; /* from here on see gx_skin */
    double *weights, *rest;
    float *normal, *texture;
    uint32_t triangle_count, triangle_capacity[7];
    gxp_skin_links *links;
    uint32_t *triangles, *fragment, *element, *material, *surface;
    uint32_t *cell;
    gxp_words first; /* element_count: the first of its triangles */
    gxp_skin_slot *slots;
    uint32_t slot_count, slot_capacity, free_slot;
    gxp_words vertex_buckets, slot_buckets;
    gxp_words boundary;    /* face_count: number among the outer faces */
    gxp_words groups;      /* outer faces x 4: group of each node's corner */
    double *group_normals; /* x 3, by group */
    uint32_t group_normal_capacity;
    gxp_words changed[2]; /* vertices, triangles */
    gx_range *ranges[2];
    uint32_t range_count[2], range_capacity[2];
    /* of a call */
    gxp_words outer_faces;                    /* element * 4 + k of each */
    gxp_words edge_faces;                     /* mesh edges, twice: the first and the second outer face there */
    gxp_words corner_points, corner_vertices; /* of a facet that is divided into triangles */
    double *normals;                          /* slots x 3 */
    double *positions;                        /* vertices x 3 */
    uint32_t normal_capacity, position_capacity;
} gxp_skin;

/* >>body: blades, working memory, the body ------------------------------------------------------------------------- */

/* Types that end those of >>state: what a blade remembers, from its creation to its destruction, and works with; the
   tree of boxes; working memory of a call; the body, of all these. No function is here. */

typedef struct gxp_bounds {
    double low[3], high[3]; /* low above high: nothing is there */
} gxp_bounds;

/* A place on a blade's edge, as one layer sees it */
typedef struct gxp_front_vertex {
    double rest[3];     /* material point; in the air at most an element's size away from the layer */
    double extended[3]; /* the same by the extended map alone: in the air as far away as the edge is */
    double position[3]; /* in space, when it was seen */
    double foot[3];     /* material point of the layer next to it; in the layer: rest */
    double foot_at[3];  /* in space, when it was seen */
    double ahead[3];    /* in which direction the front came here, of length 1; 0: it began here */
    double distance;    /* from the layer, m; 0: inside */
    double size;        /* of the element, m */
    double along;       /* index of a point of the edge, + share of the way to the next */
    uint32_t element;   /* whose map it is */
    uint8_t soft;       /* 1: says where the layer is on a straight line of the front; no corner of strips */
    uint8_t gap;        /* 1: the front ends here, and goes on elsewhere */
    uint8_t walled;     /* 1: in the air between walls of the layer; rest is on the nearer one */
    uint8_t unused;
} gxp_front_vertex;
typedef struct gxp_front_list {
    gxp_front_vertex *data;
    uint32_t count, capacity;
} gxp_front_list;
typedef struct gxp_points {
    double *data; /* count x 3 */
    uint32_t count, capacity;
} gxp_points;

/* What a layer remembers: ranges of the state's lists */
typedef struct gxp_layer {         /* words only: rows are saved as bytes */
    uint32_t front, front_count;   /* vertices: up to here it is cut */
    uint32_t latest, latest_count; /* vertices: how far the edge had come at the last move; waits to be cut */
    uint32_t path, path_count;     /* points: where the edge has been since the front was cut */
    uint32_t sheet, sheet_count;   /* points, 3 for each triangle: the last strips */
    uint32_t seen, seen_count;     /* vertices: how it saw the edge at the last move */
} gxp_layer;
typedef struct gxp_layer_list {
    gxp_layer *data;
    uint32_t count, capacity;
} gxp_layer_list;

/* A place on the edge that is followed from cell to cell while moves are left out. Lines from rest along axis + a slope
   less than radius from this one pass all that it has come to, to a quarter of the tolerance. */
typedef struct gxp_bead {
    double along;            /* index of a point of the edge, + share of the way to the next */
    double rest[3];          /* where it was in the material at the last move that was worked out, m */
    double axis[3];          /* of length 1 */
    double slope[3];         /* across axis */
    double radius, farthest; /* farthest: along axis, m; 0: it has not left rest */
    uint32_t cell, unused;   /* whose map it has */
} gxp_bead;
typedef struct gxp_bead_list {
    gxp_bead *data;
    uint32_t count, capacity;
} gxp_bead_list;

typedef struct gxp_glance { /* what a blade needs to leave out moves, see >>glances */
    uint32_t ready;         /* 1: copies.struck is where the copies were at the blade's last move. Of one blade only */
    gxp_bead_list beads;
    gxp_points edge; /* of the last move, which was left out; none: it was worked out */
    /* m: how far copies may have moved since a move was worked out; how far edge and copies may; how far beads may */
    double travelled, room, course;
    uint64_t cut; /* cuts.hash: the cells of beads are those of then */
} gxp_glance;

typedef struct gxp_blade_state { /* what lasts from move to move */
    gxp_front_list vertices;
    gxp_points points;
    gxp_layer_list layers;
    gxp_keys members;    /* slot of a near cell, layer; ascending */
    uint32_t slot_count; /* of the body then */
    gxp_points edge;     /* none: the blade is lifted */
    double middle[3];    /* of the deformed body's box then */
    gxp_glance glance;
} gxp_blade_state;

typedef struct gxp_close_cell { /* a kept cell around the edge */
    uint32_t cell, layer;
    uint32_t quad, unused;                 /* the first quad in whose box it is */
    double corners[4][3], low[3], high[3]; /* deformed */
    double middle[3], radius;              /* of a ball around the corners */
    double stretch;                        /* volume / volume at rest of its element; negative: inverted */
    double size;                           /* of its element, m */
    uint32_t facets, facet_count;          /* of a divided element's cell, once they were asked for */
    double heights[4];                     /* of the corners over the faces opposite to them, likewise, m */
    uint8_t is_divided;                    /* its element is */
    uint8_t is_bent;                       /* its map is quadratic: corners alone do not tell it */
    uint8_t has_facets, has_heights;
} gxp_close_cell;
typedef struct gxp_close_facet { /* a triangle that bounds a cell of a divided element */
    double corners[3][3];        /* deformed */
    uint32_t face, unused;       /* of its element; 4: it is a wall */
} gxp_close_facet;
typedef struct gxp_plate { /* a triangle, ready to be asked what is near it */
    double x[3][3];
    double normal[3], square;    /* of the normal's length; 0: all of the triangle is near its edges */
    double over[3][3];           /* normals of its edges in its plane, inward */
    double along[3][3], size[3]; /* edges, the squares of their lengths */
} gxp_plate;
typedef struct gxp_vicinity {
    gxp_close_cell *cells;
    uint32_t count, capacity;
    uint32_t layer_count;
    gxp_words of_cell;     /* by cell of the body: its index in cells, if it is there */
    gxp_words of_copy;     /* by copy: 1 + rank of the first cell with it; 0 between moves */
    gxp_words quad_start;  /* of each quad: the first rank of its cells */
    gxp_words ranked;      /* indices in cells by quad: layers are numbered and equals ordered by rank */
    gxp_words parents;     /* of ranks, see gxp_find */
    gxp_keys order;        /* place along the axis, index in cells: by layer, ascending */
    gxp_words layer_start; /* layer_count + 1, into order */
    int axis;
    double widest; /* of the cells along the axis */
    gxp_close_facet *facets;
    uint32_t facet_count, facet_capacity;
} gxp_vicinity;

/* Where a place on the edge lies by a layer's front */
typedef struct gxp_relation {
    double share;     /* of the nearest point on the segment */
    double distance;  /* m */
    uint32_t segment; /* of the front, the nearest */
    uint8_t ahead;    /* 1: the front advances there */
    uint8_t strays;   /* 1: the edge has left its cut through the side */
    uint8_t doubtful; /* 1: ahead only because the cut's sheet is in the air there */
    uint8_t beside;   /* 1: in the air, ahead only because it is behind and off the cut's sheet */
} gxp_relation;

/* A part of a segment of the edge that is in a cell */
typedef struct gxp_span {
    double low, high; /* shares of the segment */
    uint32_t cell, segment;
    int begins; /* once spans are joined: it does not continue the one before it */
} gxp_span;

struct gx_blade {
    gx_body *body;
    gx_blade *next;                         /* of the body's */
    double tolerance, min_advance, largest; /* m; the largest size of elements */
    double step;                            /* m: the edge goes by no more at once */
    uint32_t max_samples;
    int starts_inside;
    double slack;              /* m: how far cells may be outside of the tree's boxes now */
    gxp_blade_state now, then; /* then: what a step of a move makes */
    gxp_blade_state start;     /* what was now before the move, during the later steps of one */
    /* working memory of a move */
    gxp_vicinity near;
    gxp_points quads;  /* 4 for each part of the strip that was swept */
    gxp_plate *plates; /* of the quads, 2 each; of a layer: of its strips */
    gxp_bounds *boxes; /* around each quad, wider by the largest element */
    uint32_t plate_capacity, box_capacity;
    gxp_words found;          /* cells in a box */
    gxp_words in_scope;       /* by fragment: 1 if it is in the scope */
    gxp_words scope;          /* slots of each surface in turn */
    gxp_points corners;       /* 3 for each triangle of each surface in turn */
    gxp_words surface_starts; /* of each surface: in scope, in corners */
    gxp_words triangles;      /* 0, 1, 2 ... */
    gx_surface *surfaces;
    uint32_t surface_capacity;
    /* of one layer at a move */
    gxp_front_list front, latest, seen, samples, advanced, crossings;
    gxp_front_list strip, cut; /* 3 for each triangle: of one strip, of all */
    gxp_points path, sheet;
    /* the edge at a move, with a point wherever a layer had seen it */
    gxp_front_list places;             /* on the edge of the last move: along, ascending */
    gxp_points carried, goal;          /* where the material has carried the edge of the last move to; where it goes */
    gxp_points from, to;               /* a step's way */
    gxp_relation *relations;           /* of the samples */
    uint32_t relation_capacity, steps; /* steps: of the move */
    uint32_t last_sight;               /* a near cell: the next place on the edge is not far from it */
    double advance, room;   /* m, of all layers: the largest advance; the way of the edge before one is left */
    gxp_bead_list followed; /* where beads come to at a move */
    gxp_words needed;       /* by sample: 1 if it is not on a line with others */
    gxp_words owners;       /* old layers that flow into it */
    gxp_words heirs;        /* by old layer: new ones into which it flows */
    gxp_front_list owned;   /* their fronts in turn, with places on the edge of now */
    gxp_words owned_starts; /* owners + 1: of each in owned */
    gxp_keys halved;        /* edges of a tool, two vertices each */
    gxp_words divided;      /* triangles of a tool */
    /* of the contacts */
    gxp_span *spans; /* by segment, low and cell */
    uint32_t span_count, span_capacity;
    gxp_keys span_order; /* layer, index in spans */
};

/* --- a cache: boxes over the deformed cells --- */

/* Boxes over the deformed cells, see >>tree */
typedef struct gxp_tree {
    uint32_t cluster_count; /* a power of two; 0: the tree is not made */
    gxp_words leaf_first;   /* cluster_count x GXP_TREE_LEAVES + 1, into mesh.box_elements */
    gxp_bounds *leaf_boxes; /* cluster_count x GXP_TREE_LEAVES */
    gxp_bounds *own_boxes;  /* element_count: of elements, in the order of mesh.box_elements */
    gxp_bounds *boxes;      /* 2 x cluster_count - 1: below i are 2 i + 1 and 2 i + 2; clusters are the last ones */
    uint32_t leaf_box_capacity, own_box_capacity, box_capacity;
    gxp_words marks;         /* of boxes: GXP_BOX_MOVED, GXP_BOX_STALE */
    gxp_words node_first;    /* node_count + 1, into node_clusters */
    gxp_words node_clusters; /* clusters with elements around each node */
    double reach[3];         /* largest |coordinates| at rest */
    int wild;                /* a copy was out of range when the boxes were refitted */
    /* of a call */
    gxp_words found; /* cells at a point, ascending */
    gxp_words near;  /* places in mesh.box_elements: of elements near points that are located together */
    gxp_keys order;  /* place on a curve, point */
    gxp_words met;   /* of each box on the way down: the boxes that it meets of those that are walked together */
} gxp_tree;
enum {
    GXP_BOX_MOVED = 1, /* copies that it must contain have moved */
    GXP_BOX_STALE = 2  /* of a cluster: its leaves' boxes are older than its own */
};

/* --- contact: see >>touch --- */

typedef struct gxp_touch_vertex { /* of the surface: a sample */
    uint32_t copies[4], element, fragment;
    double weights[4]; /* of the copies that move it */
    double rest[3];    /* m */
    double normal[3];  /* outward, of length 1, at rest */
    double area, size; /* m2: its share of the surface, 0 if it is no sample of pieces; m: of its element */
    double given;      /* m2: what area is without what other vertices have given, or before it was given away */
    uint32_t stands;   /* the sample that has its area: itself, or another vertex */
    uint32_t unused;
    double young; /* Pa */
} gxp_touch_vertex;

typedef struct gxp_touch_facet {
    uint32_t vertex[3], element, fragment;
} gxp_touch_facet;

/* What a sample pressed with at the end of the last step. A sample is a vertex or, from vertex_count on, a facet */
typedef struct gxp_touch_state {
    uint32_t sample, other; /* other: a collider's id; GXP_NONE: the body itself */
    double pressed;         /* m: depth */
    double slip[3];         /* m: elastic, of its friction */
    double rest[3];         /* m: of a facet, which has many, the place */
} gxp_touch_state;

typedef struct gxp_touch_surface { /* facets by fragment, then as they lie in space at rest */
    gxp_touch_vertex *vertices;
    gxp_touch_facet *facets;
    gxp_touch_state *states; /* by sample, ascending */
    uint32_t vertex_count, facet_count, vertex_capacity, facet_capacity;
    uint32_t state_count, state_capacity;
    double largest;    /* m: size of the vertices' elements */
    gxp_words guesses; /* of each vertex: the facet that it met when it was sought last, or GXP_NONE */
    gxp_words samples; /* vertices that are, in order of the facets that they are of: near each other, facing alike */
} gxp_touch_surface;

typedef struct gxp_touch_pair {  /* of a step */
    uint32_t sample;             /* see gxp_touch_state */
    uint32_t parts;              /* of a facet's edges */
    uint32_t facet;              /* that a vertex touches; GXP_NONE: it is a collider, or nothing any more */
    uint32_t collider, other;    /* place among the step's colliders, id; GXP_NONE: none */
    double share[3];             /* of the corners of that facet; of a sample that is a facet, those of its own */
    double normal[3];            /* of the other side, in space, of length 1 */
    double gap, approach, score; /* m; m/s; m2: the smallest is taken */
    double gap_before;           /* m: after the step, what gap was before */
    double area, rest[3];        /* m2, m: of the sample */
    double pressed, slip[3];     /* m: of its state */
    double place[3], way[3];     /* m: of the collider's point at the step's start; its way within the step */
} gxp_touch_pair;

typedef struct gxp_touch_box { /* over facets */
    gxp_bounds from, to;       /* at the step's start, and at its end if nothing changes their velocities */
    gxp_bounds normals;        /* at the start */
} gxp_touch_box;

typedef struct gxp_touch_crowd { /* samples that are sought together */
    gxp_touch_box own;
    double slack, ahead, beside; /* m: how far what they meet may be at most: behind it, in front of it, beside it */
    double size;                 /* m: of their elements, the largest */
} gxp_touch_crowd;

typedef struct gxp_touch_beside { /* a sample that may come near a collider */
    uint32_t collider, parts;     /* parts above 1: it is a facet, whose edges are divided */
    double area;                  /* m2: of the facet, or of what this entry adds to a vertex */
} gxp_touch_beside;

typedef struct gxp_touch_known { /* a collider of the last step */
    uint32_t id, unused;
    uint64_t hash; /* of its shape and pose */
} gxp_touch_known;

typedef struct gxp_touch_event {                   /* what touches, as gx_contact_event has it */
    uint32_t who[3], contacts;                     /* ids: fragment, other, collider */
    double force[3], load, position[3], normal[3]; /* the last two: sums, by load */
} gxp_touch_event;

typedef struct gxp_touch {
    int on;
    gx_contact_desc desc; /* without zeros that stand for something */
    /* The surface that holds the state, and one that a step makes anew after a cut. It takes the first one's place when
       the step has succeeded. */
    gxp_touch_surface surfaces[2];
    uint32_t current;
    int made;               /* surfaces[current] is of the cuts whose hash is `hash` */
    uint64_t hash;          /* cuts.hash */
    uint64_t pressed;       /* hash of the states after the last step; 0: nothing pressed */
    gxp_touch_known *known; /* ascending ids */
    uint32_t known_count, known_capacity;
    gxp_words touching; /* what touched at the last call of gx_body_contact_events: fragment, other, collider */
    /* of a step */
    const gx_collider *colliders; /* collider_count: the caller's */
    int (*filter)(void *user, uint32_t fragment, uint32_t other, uint32_t collider);
    void *filter_user;
    uint32_t collider_count;
    gxp_keys named;    /* id, place of a collider; ascending */
    gxp_words changed; /* of each collider: 1 if it moves or is not as it was in the last step */
    gxp_touch_beside *beside;
    uint32_t beside_capacity;
    gxp_touch_pair *pairs;
    double *moved;           /* vertices x 9: position and velocity in space, outward normal */
    double *facing;          /* facets x 3: normals in space, of length 1, or 0 */
    gxp_touch_box *boxes;    /* a complete binary tree over the facets, GXP_TOUCH_LEAF in each of its leaves */
    gxp_words sides;         /* pairs x gxp_pair_span: vectors of their points */
    double *weights;         /* likewise */
    double *slips, *forces;  /* all pairs of the step x 3 */
    gxp_keys order;          /* facets; places of vertices; samples beside colliders */
    gxp_keys placed;         /* facets by element */
    gxp_keys members;        /* of a surface: sample, vertex for which it stands */
    gxp_keys edges;          /* of a surface's facets: two vertices, both ways */
    gxp_words roles;         /* of a surface's vertices: GXP_TOUCH_INSIDE ... */
    gxp_words ranked;        /* facets along a curve */
    gxp_words kept_leaves;   /* of these, those in reach of a sample */
    double *passed;          /* near.count x 6: boxes of those leaves */
    gxp_words crowd, near;   /* boxes that may hold what many samples meet; leaves that do what some of them meet */
    uint32_t leaf_count;     /* a power of two */
    uint32_t given;          /* pairs of the caller, which stand first */
    gxp_touch_event *events; /* of a call */
    uint32_t event_capacity;
    uint32_t found, kept; /* pairs of contact: of this step; of the last one that succeeded */
    uint32_t passed_capacity, pair_capacity, moved_capacity, facing_capacity, box_capacity, weight_capacity,
        slip_capacity, force_capacity;
} gxp_touch;
#define GXP_TOUCH_COPIES 16u /* copies of a pair at most: those of a vertex and of a facet's corners */

/* The boundary of a cell or leaf, as triangles in barycentric coordinates of its element */
typedef struct gxp_boundary {
    gxp_words points; /* of the complex */
    double *lambdas;  /* points x 4 */
    uint32_t lambda_capacity;
    gxp_words slots;     /* by point of the complex: its place in points, if it is there */
    gxp_words triangles; /* x 3, places in points */
    gxp_words facets;    /* in faces of the element: 2 x facet, + 1 if the material is in front */
    gxp_words leaves;    /* that it bounds */
    gxp_words fixed_of;  /* by place in points: the place in fixed, or GXP_NONE */
    gxb_fixed *fixed;    /* x 4: coordinates of those points that needed more digits */
    uint32_t fixed_count, fixed_capacity;
} gxp_boundary;

typedef struct gxp_scratch {
    uint32_t stamp;       /* of the last walk through cells or leaves */
    uint32_t scope_stamp; /* of the cells that a surface of the cut may touch */
    /* a cut, from step to step */
    gxp_words removed;    /* leaves that solids remove */
    gxp_keys removed_of;  /* element, leaf of it that solids remove */
    gxp_words pinches;    /* nodes at which walls may break joints */
    gxp_words touched;    /* cells beside new walls and removed leaves, ascending */
    gxp_words new_cells;  /* into which these fell apart: their copies and integrals are to be found */
    gxp_keys links;       /* of new cells in turn, sorted: see GXP_LINK_CELL */
    gxp_words link_first; /* new_cells.count + 1, into links */
    gxp_words narrow;     /* first and end in links of those that may be the smallest or are to be severed */
    gxp_words dead;       /* copies without cells */
    /* >>arrange */
    gxp_keys order;          /* place in the order of insertion, triangle */
    gxp_words near_elements; /* that a triangle may meet */
    /* >>pinches */
    gxp_words joint_leaves; /* around a node, or of an element */
    gxp_words joint_edges;  /* parts of edges in which these meet: joints 0, 1, ...; then a node is one */
    gxp_words joint_walls;  /* by joint: 1 if a wall touches it */
    gxp_words leaf_joints;  /* on a leaf's boundary */
    gxp_keys joint_cells;   /* joint, cell; ascending */
    gxp_keys cell_joints;   /* the same by cell */
    /* >>solids */
    gxp_words seed_leaves; /* where the flood starts */
    gxp_words flooded;     /* leaves whose winding number is known */
    gxp_words seeded;      /* by fragment: 1 if one of its leaves is a seed */
    gxp_words wound;       /* leaves around which the surfaces of a shape wind */
    gxp_words leaf_points; /* of a leaf; also of >>anchors, >>grips */
    /* >>materials */
    gxp_keys given_to;   /* leaf, surface that gives it a material; ascending. Then: leaf, its new material */
    gxp_words remade;    /* cells of whole elements that have another material, and nothing else */
    gxp_keys interfaces; /* place among new cells, cell across an interface (leaf, while cells are divided) */
    /* >>cells, >>links */
    gxp_keys glue;          /* leaf, leaf across a wall that stays in its cell, see >>specks; ascending */
    gxp_words cluster;      /* cells that hang together, see >>specks */
    gxp_keys seams;         /* leaf of one of these, leaf across a wall of the cut */
    gxp_words wall_leaves;  /* on both sides of new walls */
    gxp_words cell_leaves;  /* of a cell that is divided */
    gxp_words part_leaves;  /* of one of its connected parts */
    gxp_words facet_points; /* of a facet of a link; also of >>grips */
    /* >>components */
    gxp_keys pairs;            /* node, cell around it */
    gxp_words subdomains;      /* of a node: 2 x start in subdomain_cells, + 1 if it is open */
    gxp_words subdomain_cells; /* one subdomain after the other */
    gxp_words taken;           /* copies that one of these keeps */
    gxp_words face_facets;     /* of an element's face */
    /* >>integrals, >>vertices */
    gxp_boundary boundary;
    /* >>sheets */
    gxp_words sheet_cells; /* that may have become thin */
    gxp_words bulk_of;     /* by copy: its place in bulks, or GXP_NONE */
    gxp_words bulk_met;    /* by copy: the last walk that has met it */
    gxp_words bent;        /* copies that become affine; some more than once */
    gxp_bulk *bulks;
    uint32_t bulk_count, bulk_capacity;
} gxp_scratch;

/* Divided by lifetime. Each array is listed in gxp_tables or gxp_lists, by which it grows and is released. */
struct gx_body {
    gxp_config config;
    gxp_mesh mesh;
    gxb_complex *complex;
    gxs_solver *solver;
    gxp_cells cells;
    gxp_slots slots;
    gxp_leaves leaves;
    gxp_copies copies;
    gxp_cuts cuts;
    gxp_holds holds;
    gxp_undo undo;
    gxp_view view;
    gxp_snapshot snapshot;
    gxp_model model;
    gxp_hidden hidden;
    gxp_attached attached;
    gxp_skin skin;
    gx_blade *blades; /* list through next */
    gxp_tree tree;
    gxp_touch touch;
    gxp_scratch scratch;
};

/* >>columns: every array of a body --------------------------------------------------------------------------------- */

/* Each array of a body is listed here once, with the size of an entry. Columns of one table have an entry for each row.
   Growth, undo, save, load, clone, hashes and destruction read these lists. An array that is added to a struct above is
   added here, and nowhere else; a column takes one more place in its struct's capacity. */

enum {
    GXP_TOPOLOGY = 1, /* saved, and hashed in the state: made by cuts */
    GXP_STATE = 2,    /* saved and hashed: all else */
    GXP_HISTORY = 4,  /* saved and hashed if the last step was one of BDF2 */
    GXP_UNDONE = 8,   /* rows are put back when a cut fails */
    GXP_CLEARED = 16, /* new rows are 0 */
    GXP_LATER = 32,   /* NULL until it is needed */
    GXP_STROKE = 64,  /* saved and hashed while a blade may leave out moves */
    GXP_AFFINE = 128  /* saved and hashed if the body can have affine copies */
};

/* Offsets in gx_body: of the pointer, of the number of entries that there is room for; bytes of an entry */
typedef struct gxp_column {
    size_t array, capacity, size;
    uint32_t use;
} gxp_column;

typedef struct gxp_table {
    size_t count; /* offset in gx_body of the number of rows */
    const gxp_column *columns;
    uint32_t column_count;
} gxp_table;

/* clang-format off */
#define GXP_COLUMN(part, member, capacity, index, size, use) \
    {offsetof(gx_body, part.member), offsetof(gx_body, part.capacity) + (index) * sizeof(uint32_t), size, use}

static const gxp_column gxp_node_columns[] = {
    GXP_COLUMN(mesh, positions,    node_capacity, 0, 3 * sizeof(double), 0),
    GXP_COLUMN(mesh, node_start,   node_capacity, 1, sizeof(uint32_t), 0),
    GXP_COLUMN(mesh, node_pinched, node_capacity, 2, sizeof(uint8_t), 0),
    GXP_COLUMN(mesh, texture,      node_capacity, 3, 2 * sizeof(float), GXP_LATER)};
static const gxp_column gxp_element_columns[] = {
    GXP_COLUMN(mesh, node_elements,     element_capacity, 0, 4 * sizeof(uint32_t), 0),
    GXP_COLUMN(mesh, boxes,             element_capacity, 1, sizeof(gxp_box), 0),
    GXP_COLUMN(mesh, box_elements,      element_capacity, 2, sizeof(uint32_t), 0),
    GXP_COLUMN(mesh, element_materials, element_capacity, 3, sizeof(uint32_t), 0),
    GXP_COLUMN(mesh, sizes,             element_capacity, 4, sizeof(double), GXP_LATER)};
static const gxp_column gxp_edge_columns[] = {
    GXP_COLUMN(mesh, edge_pinched, edge_capacity, 0, sizeof(uint8_t), 0)};
static const gxp_column gxp_material_columns[] = {
    GXP_COLUMN(mesh, materials, material_capacity, 0, sizeof(gx_material), 0)};
static const gxp_column gxp_cell_columns[] = {
    GXP_COLUMN(cells, data,      capacity, 0, sizeof(gxp_cell), GXP_TOPOLOGY | GXP_UNDONE),
    GXP_COLUMN(cells, stamp,     capacity, 1, sizeof(uint32_t), GXP_CLEARED),
    GXP_COLUMN(cells, saved_by,  capacity, 2, sizeof(uint32_t), GXP_CLEARED),
    GXP_COLUMN(cells, new_index, capacity, 3, sizeof(uint32_t), GXP_CLEARED),
    GXP_COLUMN(cells, slot,      capacity, 4, sizeof(uint32_t), GXP_TOPOLOGY)};
static const gxp_column gxp_slot_columns[] = {
    GXP_COLUMN(slots, parent, capacity, 0, sizeof(uint32_t), GXP_TOPOLOGY)};
static const gxp_column gxp_leaf_columns[] = {
    GXP_COLUMN(leaves, data, capacity, 0, sizeof(gxp_leaf), GXP_TOPOLOGY | GXP_UNDONE),
    GXP_COLUMN(leaves, mark, capacity, 1, sizeof(gxp_leaf_mark), GXP_CLEARED)};
static const gxp_column gxp_copy_columns[] = {
    GXP_COLUMN(copies, node,         capacity,  0, sizeof(uint32_t), GXP_TOPOLOGY),
    GXP_COLUMN(copies, displacement, capacity,  1, 3 * sizeof(double), GXP_STATE),
    GXP_COLUMN(copies, velocity,     capacity,  2, 3 * sizeof(double), GXP_STATE),
    GXP_COLUMN(copies, rest_time,    capacity,  3, sizeof(double), GXP_STATE),
    GXP_COLUMN(copies, label,        capacity,  4, sizeof(uint32_t), GXP_STATE),
    GXP_COLUMN(copies, before,       capacity,  5, sizeof(uint32_t), 0),
    GXP_COLUMN(copies, held,         capacity,  6, sizeof(uint8_t), 0),
    GXP_COLUMN(copies, history[0],   capacity,  7, 3 * sizeof(double), GXP_HISTORY | GXP_LATER),
    GXP_COLUMN(copies, history[1],   capacity,  8, 3 * sizeof(double), GXP_HISTORY | GXP_LATER),
    GXP_COLUMN(copies, history[2],   capacity,  9, 3 * sizeof(double), GXP_LATER),
    GXP_COLUMN(copies, history[3],   capacity, 10, 3 * sizeof(double), GXP_LATER),
    GXP_COLUMN(copies, seen,         capacity, 11, 3 * sizeof(double), GXP_LATER),
    GXP_COLUMN(copies, struck,       capacity, 12, 3 * sizeof(double), GXP_STROKE | GXP_LATER),
    GXP_COLUMN(copies, affine,       capacity, 13, sizeof(uint8_t), GXP_AFFINE | GXP_LATER),
    GXP_COLUMN(copies, linear,       capacity, 14, 9 * sizeof(double), GXP_AFFINE | GXP_LATER),
    GXP_COLUMN(copies, linear_rate,  capacity, 15, 9 * sizeof(double), GXP_AFFINE | GXP_LATER),
    GXP_COLUMN(copies, linear_history[0], capacity, 16, 9 * sizeof(double), GXP_AFFINE | GXP_LATER),
    GXP_COLUMN(copies, linear_history[1], capacity, 17, 9 * sizeof(double), GXP_AFFINE | GXP_LATER),
    GXP_COLUMN(copies, linear_seen,  capacity, 18, 9 * sizeof(double), GXP_LATER)};
enum { /* places in the lists above */
    GXP_TEXTURE_COLUMN = 3,
    GXP_SIZE_COLUMN = 4,
    GXP_FIRST_HISTORY = 7,
    GXP_SEEN_COLUMN = 11,
    GXP_STRUCK_COLUMN = 12,
    GXP_FIRST_AFFINE = 13,
    GXP_AFFINE_COLUMNS = 5,
    GXP_LINEAR_SEEN_COLUMN = 18,
    GXP_VIEWED_MATERIALS = 6
};
static const gxp_column gxp_surface_columns[] = {
    GXP_COLUMN(cuts, surfaces, surface_capacity, 0, sizeof(gxp_surface_record), GXP_TOPOLOGY)};
static const gxp_column gxp_map_columns[] = {
    GXP_COLUMN(cuts, maps, map_capacity, 0, 8 * sizeof(double), GXP_TOPOLOGY)};
static const gxp_column gxp_region_columns[] = {
    GXP_COLUMN(holds, regions, capacity, 0, sizeof(gxp_region), GXP_STATE)};
static const gxp_column gxp_region_index_columns[] = {
    GXP_COLUMN(holds, indices, index_capacity, 0, sizeof(uint32_t), GXP_STATE)};
static const gxp_column gxp_region_vertex_columns[] = {
    GXP_COLUMN(holds, vertices, vertex_capacity, 0, 3 * sizeof(double), GXP_STATE)};
static const gxp_column gxp_snapshot_columns[] = {
    GXP_COLUMN(snapshot, id,     capacity, 0, sizeof(uint32_t), GXP_STATE),
    GXP_COLUMN(snapshot, origin, capacity, 1, sizeof(uint32_t), GXP_STATE),
    GXP_COLUMN(snapshot, change, capacity, 2, sizeof(uint32_t), GXP_STATE)};
static const gxp_column gxp_removed_id_columns[] = {
    GXP_COLUMN(snapshot, removed.data, removed.capacity, 0, sizeof(uint32_t), GXP_STATE)};
static const gxp_column gxp_view_columns[] = {
    GXP_COLUMN(view, slot,     capacity, 0, sizeof(uint32_t), 0),
    GXP_COLUMN(view, fragment, capacity, 1, sizeof(uint32_t), 0),
    GXP_COLUMN(view, element,  capacity, 2, sizeof(uint32_t), 0),
    GXP_COLUMN(view, copies,   capacity, 3, 4 * sizeof(uint32_t), 0),
    GXP_COLUMN(view, volume,   capacity, 4, sizeof(double), 0),
    GXP_COLUMN(view, cell,     capacity, 5, sizeof(uint32_t), 0),
    GXP_COLUMN(view, material, capacity, 6, sizeof(uint32_t), GXP_LATER)};
static const gxp_column gxp_sum_columns[] = {
    GXP_COLUMN(view, fragment_volume,  sum_capacity, 0, sizeof(double), 0),
    GXP_COLUMN(view, fragment_mass,    sum_capacity, 1, sizeof(double), 0),
    GXP_COLUMN(view, fragment_center,  sum_capacity, 2, 3 * sizeof(double), 0),
    GXP_COLUMN(view, fragment_inertia, sum_capacity, 3, 6 * sizeof(double), 0)};
static const gxp_column gxp_skin_vertex_columns[] = {
    GXP_COLUMN(skin, vertices, vertex_capacity, 0, sizeof(gxp_skin_vertex), 0),
    GXP_COLUMN(skin, copies,   vertex_capacity, 1, 4 * sizeof(uint32_t), 0),
    GXP_COLUMN(skin, weights,  vertex_capacity, 2, 4 * sizeof(double), 0),
    GXP_COLUMN(skin, point,    vertex_capacity, 3, sizeof(uint32_t), 0),
    GXP_COLUMN(skin, rest,     vertex_capacity, 4, 3 * sizeof(double), 0),
    GXP_COLUMN(skin, normal,   vertex_capacity, 5, 3 * sizeof(float), 0),
    GXP_COLUMN(skin, texture,  vertex_capacity, 6, 2 * sizeof(float), 0)};
static const gxp_column gxp_skin_triangle_columns[] = {
    GXP_COLUMN(skin, links,     triangle_capacity, 0, sizeof(gxp_skin_links), 0),
    GXP_COLUMN(skin, triangles, triangle_capacity, 1, 3 * sizeof(uint32_t), 0),
    GXP_COLUMN(skin, fragment,  triangle_capacity, 2, sizeof(uint32_t), 0),
    GXP_COLUMN(skin, element,   triangle_capacity, 3, sizeof(uint32_t), 0),
    GXP_COLUMN(skin, material,  triangle_capacity, 4, sizeof(uint32_t), 0),
    GXP_COLUMN(skin, surface,   triangle_capacity, 5, sizeof(uint32_t), 0),
    GXP_COLUMN(skin, cell,      triangle_capacity, 6, sizeof(uint32_t), 0)};

#define GXP_TABLE(count, columns) {offsetof(gx_body, count), columns, sizeof columns / sizeof *columns}

static const gxp_table gxp_tables[GXP_TABLES] = { /* in the order of GXP_NODES ... */
    GXP_TABLE(mesh.node_count, gxp_node_columns),
    GXP_TABLE(mesh.element_count, gxp_element_columns),
    GXP_TABLE(mesh.edge_count, gxp_edge_columns),
    GXP_TABLE(mesh.material_count, gxp_material_columns),
    GXP_TABLE(cells.count, gxp_cell_columns),
    GXP_TABLE(slots.count, gxp_slot_columns),
    GXP_TABLE(leaves.count, gxp_leaf_columns),
    GXP_TABLE(copies.count, gxp_copy_columns),
    GXP_TABLE(cuts.surface_count, gxp_surface_columns),
    GXP_TABLE(cuts.map_count, gxp_map_columns),
    GXP_TABLE(holds.count, gxp_region_columns),
    GXP_TABLE(holds.index_count, gxp_region_index_columns),
    GXP_TABLE(holds.vertex_count, gxp_region_vertex_columns),
    GXP_TABLE(snapshot.count, gxp_snapshot_columns),
    GXP_TABLE(snapshot.removed.count, gxp_removed_id_columns),
    GXP_TABLE(view.count, gxp_view_columns),
    GXP_TABLE(view.fragment_count, gxp_sum_columns),
    GXP_TABLE(skin.vertex_count, gxp_skin_vertex_columns),
    GXP_TABLE(skin.triangle_count, gxp_skin_triangle_columns)};

#define GXP_LIST(member, room, size) {offsetof(gx_body, member), offsetof(gx_body, room), size, 0}
#define GXP_WORDS(list) GXP_LIST(list.data, list.capacity, sizeof(uint32_t))
#define GXP_KEYS(list)  GXP_LIST(list.data, list.capacity, sizeof(uint64_t))

static const gxp_column gxp_model_lists[] = { /* released once the solver has copied them */
    GXP_LIST(model.parts, model.part_capacity, sizeof(gxs_element)),
    GXP_LIST(model.rest, model.rest_capacity, 3 * sizeof(double)),
    GXP_LIST(model.elastic, model.elastic_capacity, sizeof(gxs_material)),
    GXP_LIST(model.constraints, model.constraint_capacity, sizeof(gxs_constraint))};
static const gxp_column gxp_lists[] = {
    GXP_WORDS(undo.cells.rows), GXP_LIST(undo.cells.bytes, undo.cells.byte_capacity, 1),
    GXP_WORDS(undo.leaves.rows), GXP_LIST(undo.leaves.bytes, undo.leaves.byte_capacity, 1),
    GXP_WORDS(holds.node_first), GXP_WORDS(holds.nodes), GXP_WORDS(holds.region_of), GXP_WORDS(holds.near_nodes),
    GXP_WORDS(holds.probe.points), GXP_WORDS(holds.probe.reached),
    GXP_LIST(holds.probe.triangles, holds.probe.triangle_capacity, sizeof(gxb_triangle)),
    GXP_WORDS(view.indices), GXP_WORDS(view.copy_fragment), GXP_WORDS(view.fragment_number),
    GXP_WORDS(view.splits), GXP_WORDS(view.split_cells), GXP_WORDS(view.split_parents),
    GXP_WORDS(model.changed), GXP_WORDS(model.thin),
    GXP_WORDS(hidden.copies), GXP_WORDS(hidden.first), GXP_WORDS(hidden.before), GXP_WORDS(hidden.origins),
    GXP_LIST(hidden.held, hidden.held_capacity, 1),
    GXP_LIST(hidden.plain, hidden.plain_capacity, 1),
    GXP_LIST(hidden.state, hidden.state_capacity, sizeof(double)), GXP_WORDS(hidden.span_copies),
    GXP_LIST(hidden.span_weights, hidden.span_capacity, sizeof(double)),
    GXP_LIST(attached.springs, attached.spring_capacity, sizeof(gxs_spring)),
    GXP_LIST(attached.points, attached.point_capacity, sizeof(gxs_point)),
    GXP_LIST(attached.pairs, attached.pair_capacity, sizeof(gxs_pair)),
    GXP_WORDS(attached.sides),
    GXP_LIST(attached.weights, attached.weight_capacity, sizeof(double)),
    GXP_LIST(attached.forces, attached.force_capacity, 3 * sizeof(double)),
    GXP_LIST(attached.targets, attached.target_capacity, 3 * sizeof(double)),
    GXP_WORDS(skin.dirty), GXP_WORDS(skin.first), GXP_LIST(skin.slots, skin.slot_capacity, sizeof(gxp_skin_slot)),
    GXP_WORDS(skin.vertex_buckets), GXP_WORDS(skin.slot_buckets), GXP_WORDS(skin.boundary), GXP_WORDS(skin.groups),
    GXP_LIST(skin.group_normals, skin.group_normal_capacity, 3 * sizeof(double)),
    GXP_WORDS(skin.changed[0]), GXP_LIST(skin.ranges[0], skin.range_capacity[0], sizeof(gx_range)),
    GXP_WORDS(skin.changed[1]), GXP_LIST(skin.ranges[1], skin.range_capacity[1], sizeof(gx_range)),
    GXP_WORDS(skin.outer_faces), GXP_WORDS(skin.edge_faces),
    GXP_WORDS(skin.corner_points), GXP_WORDS(skin.corner_vertices),
    GXP_LIST(skin.normals, skin.normal_capacity, 3 * sizeof(double)),
    GXP_LIST(skin.positions, skin.position_capacity, 3 * sizeof(double)),
    GXP_WORDS(tree.leaf_first), GXP_LIST(tree.leaf_boxes, tree.leaf_box_capacity, sizeof(gxp_bounds)),
    GXP_LIST(tree.own_boxes, tree.own_box_capacity, sizeof(gxp_bounds)),
    GXP_LIST(tree.boxes, tree.box_capacity, sizeof(gxp_bounds)), GXP_WORDS(tree.marks),
    GXP_WORDS(tree.node_first), GXP_WORDS(tree.node_clusters), GXP_WORDS(tree.found), GXP_WORDS(tree.near),
    GXP_KEYS(tree.order), GXP_WORDS(tree.met),
    GXP_LIST(touch.surfaces[0].vertices, touch.surfaces[0].vertex_capacity, sizeof(gxp_touch_vertex)),
    GXP_LIST(touch.surfaces[0].facets, touch.surfaces[0].facet_capacity, sizeof(gxp_touch_facet)),
    GXP_LIST(touch.surfaces[1].vertices, touch.surfaces[1].vertex_capacity, sizeof(gxp_touch_vertex)),
    GXP_LIST(touch.surfaces[1].facets, touch.surfaces[1].facet_capacity, sizeof(gxp_touch_facet)),
    GXP_LIST(touch.surfaces[0].states, touch.surfaces[0].state_capacity, sizeof(gxp_touch_state)),
    GXP_LIST(touch.surfaces[1].states, touch.surfaces[1].state_capacity, sizeof(gxp_touch_state)),
    GXP_WORDS(touch.surfaces[0].guesses), GXP_WORDS(touch.surfaces[1].guesses),
    GXP_WORDS(touch.surfaces[0].samples), GXP_WORDS(touch.surfaces[1].samples),
    GXP_WORDS(touch.crowd),               GXP_WORDS(touch.near), GXP_WORDS(touch.kept_leaves),
    GXP_LIST(touch.known, touch.known_capacity, sizeof(gxp_touch_known)),
    GXP_LIST(touch.pairs, touch.pair_capacity, sizeof(gxp_touch_pair)),
    GXP_LIST(touch.moved, touch.moved_capacity, 9 * sizeof(double)),
    GXP_LIST(touch.passed, touch.passed_capacity, sizeof(double)),
    GXP_LIST(touch.facing, touch.facing_capacity, 3 * sizeof(double)),
    GXP_LIST(touch.events, touch.event_capacity, sizeof(gxp_touch_event)), GXP_WORDS(touch.touching),
    GXP_LIST(touch.boxes, touch.box_capacity, sizeof(gxp_touch_box)), GXP_WORDS(touch.sides),
    GXP_LIST(touch.weights, touch.weight_capacity, sizeof(double)),
    GXP_LIST(touch.slips, touch.slip_capacity, 3 * sizeof(double)),
    GXP_LIST(touch.forces, touch.force_capacity, 3 * sizeof(double)),
    GXP_KEYS(touch.order), GXP_WORDS(touch.ranked), GXP_KEYS(touch.named), GXP_WORDS(touch.changed),
    GXP_LIST(touch.beside, touch.beside_capacity, sizeof(gxp_touch_beside)), GXP_KEYS(touch.placed),
    GXP_KEYS(touch.edges), GXP_KEYS(touch.members), GXP_WORDS(touch.roles),
    GXP_WORDS(scratch.removed), GXP_KEYS(scratch.removed_of), GXP_WORDS(scratch.pinches), GXP_WORDS(scratch.touched),
    GXP_WORDS(scratch.new_cells),
    GXP_KEYS(scratch.links), GXP_KEYS(scratch.glue), GXP_KEYS(scratch.seams), GXP_WORDS(scratch.cluster),
    GXP_WORDS(scratch.link_first), GXP_WORDS(scratch.narrow), GXP_WORDS(scratch.dead),
    GXP_KEYS(scratch.order), GXP_WORDS(scratch.near_elements),
    GXP_WORDS(scratch.joint_leaves), GXP_WORDS(scratch.joint_edges), GXP_WORDS(scratch.joint_walls),
    GXP_WORDS(scratch.leaf_joints), GXP_KEYS(scratch.joint_cells), GXP_KEYS(scratch.cell_joints),
    GXP_WORDS(scratch.seed_leaves), GXP_WORDS(scratch.flooded), GXP_WORDS(scratch.seeded), GXP_WORDS(scratch.wound),
    GXP_WORDS(scratch.leaf_points),
    GXP_KEYS(scratch.given_to), GXP_WORDS(scratch.remade), GXP_KEYS(scratch.interfaces),
    GXP_WORDS(scratch.wall_leaves), GXP_WORDS(scratch.cell_leaves), GXP_WORDS(scratch.part_leaves),
    GXP_WORDS(scratch.facet_points),
    GXP_KEYS(scratch.pairs), GXP_WORDS(scratch.subdomains), GXP_WORDS(scratch.subdomain_cells),
    GXP_WORDS(scratch.taken), GXP_WORDS(scratch.face_facets),
    GXP_WORDS(scratch.boundary.points), GXP_WORDS(scratch.boundary.slots), GXP_WORDS(scratch.boundary.triangles),
    GXP_WORDS(scratch.boundary.facets), GXP_WORDS(scratch.boundary.leaves), GXP_WORDS(scratch.boundary.fixed_of),
    GXP_LIST(scratch.boundary.lambdas, scratch.boundary.lambda_capacity, 4 * sizeof(double)),
    GXP_LIST(scratch.boundary.fixed, scratch.boundary.fixed_capacity, 4 * sizeof(gxb_fixed)),
    GXP_WORDS(scratch.sheet_cells), GXP_WORDS(scratch.bulk_of), GXP_WORDS(scratch.bulk_met), GXP_WORDS(scratch.bent),
    GXP_LIST(scratch.bulks, scratch.bulk_capacity, sizeof(gxp_bulk))};
/* clang-format on */

/* >>memory: allocation, growing arrays ----------------------------------------------------------------------------- */

/* In: an allocator, arrays, the items that they are to hold. Out: room for them, or GX_ERROR_MEMORY or GX_ERROR_LIMIT
   and everything as it was. gxp_reserve is the one way by which an array grows; gxp_grow_rows applies it to all columns
   of a table. */

static void *gxp_allocate(const gx_allocator *a, size_t size) {
    return a->allocate ? a->allocate(a->user, size) : malloc(size);
}

static void gxp_release(const gx_allocator *a, void *memory, size_t size) {
    if (memory == NULL) return;
    if (a->release)
        a->release(a->user, memory, size);
    else
        free(memory);
}

/* Returns a larger block with the first `used` bytes of the old one, and releases that. NULL: there is no memory, and
   the old block stays. */
static void *gxp_reallocate(const gx_allocator *a, void *old, size_t old_size, size_t used, size_t size) {
    void *memory;
    /* moves the pages of large blocks, not their bytes */
    if (a->allocate == NULL) return realloc(old, size);
    if (a->reallocate != NULL && old != NULL) return a->reallocate(a->user, old, old_size, size);
    memory = gxp_allocate(a, size);
    if (memory == NULL) return NULL;
    if (used > 0) memcpy(memory, old, used);
    gxp_release(a, old, old_size);
    return memory;
}

/* Moves an array that is full to a larger block: half as much again as is needed. */
static gx_result gxp_grow(const gx_allocator *a, void *array, size_t item, size_t count, uint32_t *capacity,
                          size_t extra) {
    const size_t need = count + extra, room = need + need / 2 + 16;
    void *old, *memory;
    if (room > INT32_MAX || room > SIZE_MAX / item) return GX_ERROR_LIMIT;
    memcpy(&old, array, sizeof old);
    memory = gxp_reallocate(a, old, (size_t)*capacity * item, count * item, room * item);
    if (memory == NULL) return GX_ERROR_MEMORY;
    memcpy(array, &memory, sizeof memory);
    *capacity = (uint32_t)room;
    return GX_OK;
}

/* Does an array have room? tests/test_tight.c says no and has no memory then: memory runs out wherever an array could
   grow. */
#ifndef GXP_HAS_ROOM
#define GXP_HAS_ROOM(allocator, need, capacity) ((need) <= (capacity))
#endif

/* Makes room for count + extra items; array is the address of the pointer. */
static inline gx_result gxp_reserve(const gx_allocator *a, void *array, size_t item, size_t count, uint32_t *capacity,
                                    size_t extra) {
    return GXP_HAS_ROOM(a, count + extra, *capacity) ? GX_OK : gxp_grow(a, array, item, count, capacity, extra);
}

static gx_result gxp_words_room(gx_body *body, gxp_words *words, size_t extra) {
    return gxp_reserve(&body->config.allocator, &words->data, sizeof *words->data, words->count, &words->capacity,
                       extra);
}

static gx_result gxp_push(gx_body *body, gxp_words *words, uint32_t value) {
    const gx_result result = gxp_words_room(body, words, 1);
    if (result == GX_OK) words->data[words->count++] = value;
    return result;
}

/* Empty, with room for count words */
static gx_result gxp_start_words(gx_body *body, gxp_words *words, size_t count) {
    words->count = 0;
    return gxp_words_room(body, words, count);
}

#define GXP_FIRST(key)  ((uint32_t)((key) >> 32))
#define GXP_SECOND(key) ((uint32_t)(key))
/* A facet of a link, as a cell has it: the cell behind it, the facet, its face of the element; 31, 31 and 2 bits */
#define GXP_LINK_CELL(link)  ((uint32_t)((link) >> 33))
#define GXP_LINK_FACET(link) ((uint32_t)((link) >> 2) & 0x7fffffffu)
#define GXP_LINK_FACE(link)  ((uint32_t)(link)&3)

static gx_result gxp_keys_room(gx_body *body, gxp_keys *keys, size_t extra) {
    return gxp_reserve(&body->config.allocator, &keys->data, sizeof *keys->data, keys->count, &keys->capacity, extra);
}

static gx_result gxp_push_key(gx_body *body, gxp_keys *keys, uint32_t first, uint32_t second) {
    const gx_result result = gxp_keys_room(body, keys, 1);
    if (result == GX_OK) keys->data[keys->count++] = (uint64_t)first << 32 | second;
    return result;
}

static void *gxp_array_at(const gx_body *body, const gxp_column *column) {
    void *array;
    memcpy(&array, (const char *)body + column->array, sizeof array);
    return array;
}

static uint32_t *gxp_capacity_at(gx_body *body, const gxp_column *column) {
    return (uint32_t *)(void *)((char *)body + column->capacity);
}

static uint32_t gxp_count(const gx_body *body, uint32_t table) {
    uint32_t count;
    memcpy(&count, (const char *)body + gxp_tables[table].count, sizeof count);
    return count;
}

static uint32_t *gxp_count_at(gx_body *body, uint32_t table) {
    return (uint32_t *)(void *)((char *)body + gxp_tables[table].count);
}

/* Room for rows in a column; rows before `used` keep what they have. In a column that is cleared, all rows do. */
static gx_result gxp_grow_column(gx_body *body, const gxp_column *column, size_t used, size_t rows) {
    uint32_t *capacity = gxp_capacity_at(body, column);
    const uint32_t before = *capacity;
    gx_result result;
    if (rows <= before) return GX_OK;
    if (used > before || (column->use & GXP_CLEARED)) used = before;
    result =
        gxp_reserve(&body->config.allocator, (char *)body + column->array, column->size, used, capacity, rows - used);
    if (result == GX_OK && (column->use & GXP_CLEARED))
        memset((char *)gxp_array_at(body, column) + before * column->size, 0, (*capacity - before) * column->size);
    return result;
}

/* Room for extra further rows of a table. After an error some columns have it, which does no harm. */
static gx_result gxp_grow_rows(gx_body *body, uint32_t table, size_t extra) {
    const gxp_column *column = gxp_tables[table].columns, *end = column + gxp_tables[table].column_count;
    const size_t count = *gxp_count_at(body, table);
    gx_result result = GX_OK;
    for (; column < end && result == GX_OK; column++)
        if (count + extra > *gxp_capacity_at(body, column) &&
            (!(column->use & GXP_LATER) || *gxp_capacity_at(body, column) > 0))
            result = gxp_grow_column(body, column, count, count + extra);
    return result;
}

/* Exactly that many rows, all 0, of a column that has none; at least one, so that there is memory. */
static gx_result gxp_make_column(gx_body *body, const gxp_column *column, size_t rows) {
    void *memory;
    if (rows == 0) rows = 1;
    if (rows > SIZE_MAX / column->size) return GX_ERROR_LIMIT;
    memory = gxp_allocate(&body->config.allocator, rows * column->size);
    if (memory == NULL) return GX_ERROR_MEMORY;
    memset(memory, 0, rows * column->size);
    memcpy((char *)body + column->array, &memory, sizeof memory);
    *gxp_capacity_at(body, column) = (uint32_t)rows;
    return GX_OK;
}

static gx_result gxp_make_rows(gx_body *body, uint32_t table, size_t rows) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < gxp_tables[table].column_count && result == GX_OK; i++)
        if (!(gxp_tables[table].columns[i].use & GXP_LATER))
            result = gxp_make_column(body, &gxp_tables[table].columns[i], rows);
    return result;
}

/* Two columns of the same size change places. */
static void gxp_swap_columns(gx_body *body, const gxp_column *a, const gxp_column *b) {
    void *p = gxp_array_at(body, a), *q = gxp_array_at(body, b);
    const uint32_t capacity = *gxp_capacity_at(body, a);
    memcpy((char *)body + a->array, &q, sizeof q);
    memcpy((char *)body + b->array, &p, sizeof p);
    *gxp_capacity_at(body, a) = *gxp_capacity_at(body, b);
    *gxp_capacity_at(body, b) = capacity;
}

static void gxp_release_columns(gx_body *body, const gxp_column *columns, size_t count) {
    for (; count > 0; count--, columns++) {
        uint32_t *capacity = gxp_capacity_at(body, columns);
        gxp_release(&body->config.allocator, gxp_array_at(body, columns), *capacity * columns->size);
        memset((char *)body + columns->array, 0, sizeof(void *));
        *capacity = 0;
    }
}

/* memcpy where most sizes are known: a call for each column of a row would cost more than the row. */
static void gxp_move_item(char *to, const char *from, size_t size) {
    switch (size) {
    case 4: memcpy(to, from, 4); break;
    case 8: memcpy(to, from, 8); break;
    case 24: memcpy(to, from, 24); break;
    default: memcpy(to, from, size);
    }
}

/* Row `to` of a table becomes a copy of row `from`. */
static void gxp_copy_row(gx_body *body, uint32_t table, size_t from, size_t to) {
    const gxp_column *column = gxp_tables[table].columns, *end = column + gxp_tables[table].column_count;
    for (; column < end; column++) {
        char *data = (char *)gxp_array_at(body, column);
        if (data != NULL) gxp_move_item(data + to * column->size, data + from * column->size, column->size);
    }
}

/* Bytes of a row in the columns of that use */
static size_t gxp_row_size(uint32_t table, uint32_t use) {
    size_t size = 0;
    uint32_t i;
    for (i = 0; i < gxp_tables[table].column_count; i++)
        if (gxp_tables[table].columns[i].use & use) size += gxp_tables[table].columns[i].size;
    return size;
}

/* >>basics: sorting, hashing, sets, vectors ------------------------------------------------------------------------ */
/* Small functions that know nothing of a body. They change nothing but what they are given. */

/* Sorts ascending by the bits from `bit` down; words without the bit come first [radix exchange, Hildebrandt and Isbitz
   1959]. */
static void gxp_sort_by_bits(uint32_t *w, uint32_t count, uint32_t bit) {
    while (count > 1 && bit != 0) {
        uint32_t i = 0, j = count;
        while (i < j) {
            if (!(w[i] & bit)) {
                i++;
                continue;
            }
            while (--j > i && (w[j] & bit)) continue;
            if (j > i) {
                const uint32_t t = w[i];
                w[i++] = w[j];
                w[j] = t;
            }
        }
        bit >>= 1;
        gxp_sort_by_bits(w + i, count - i, bit);
        count = i;
    }
}

static void gxp_sort_unique(gxp_words *w) {
    uint32_t i, n = 0, all = 0, bit = 1;
    for (i = 0; i < w->count; i++) all |= w->data[i];
    while (all >> 1 >= bit) bit <<= 1;
    gxp_sort_by_bits(w->data, w->count, bit);
    for (i = 0; i < w->count; i++)
        if (n == 0 || w->data[i] != w->data[n - 1]) w->data[n++] = w->data[i];
    w->count = n;
}

static void gxp_sort_few_keys(uint64_t *key, uint32_t count) {
    uint32_t i, j;
    for (i = 1; i < count; i++) {
        const uint64_t k = key[i];
        for (j = i; j > 0 && key[j - 1] > k; j--) key[j] = key[j - 1];
        key[j] = k;
    }
}

/* The first of ascending keys that is not below a key; their count if all are */
static uint32_t gxp_first_key(const gxp_keys *keys, uint64_t key) {
    uint32_t low = 0, high = keys->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (keys->data[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Sorts keys from ... to-1, ascending. Few keys are sorted by insertion, many by digits of 8 bits from the lowest on;
   digits in which all keys agree are skipped [radix sort, Knuth vol. 3, 5.2.5]. */
static gx_result gxp_sort_keys(gx_body *body, gxp_keys *keys, uint32_t from, uint32_t to) {
    const uint32_t n = to - from;
    const gx_result result = n > 64 ? gxp_keys_room(body, keys, n) : GX_OK;
    uint64_t *source, *target, differ = 0;
    uint32_t shift, i;
    if (result != GX_OK || n < 2) return result;
    source = keys->data + from;
    target = keys->data + keys->count;
    if (n <= 64) {
        gxp_sort_few_keys(source, n);
        return GX_OK;
    }
    for (i = 1; i < n; i++) differ |= source[i] ^ source[0];
    for (shift = 0; shift < 64; shift += 8) {
        uint32_t place[257] = {0};
        uint64_t *const sorted = target;
        if (!(differ >> shift & 255)) continue;
        for (i = 0; i < n; i++) place[1 + (source[i] >> shift & 255)]++;
        for (i = 0; i < 256; i++) place[i + 1] += place[i];
        for (i = 0; i < n; i++) target[place[source[i] >> shift & 255]++] = source[i];
        target = source;
        source = sorted;
    }
    if (source != keys->data + from) memcpy(keys->data + from, source, n * sizeof *source);
    return GX_OK;
}

static int gxp_contains(const gxp_words *words, uint32_t value) {
    uint32_t i;
    for (i = 0; i < words->count; i++)
        if (words->data[i] == value) return 1;
    return 0;
}

static uint32_t gxp_find(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static void gxp_unite(uint32_t *parent, uint32_t i, uint32_t j) {
    i = gxp_find(parent, i);
    j = gxp_find(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

static void gxp_unite_all(uint32_t *parent, const uint32_t copies[4]) {
    uint32_t root = gxp_find(parent, copies[0]), k;
    for (k = 1; k < 4; k++) {
        const uint32_t other = gxp_find(parent, copies[k]);
        if (other < root) {
            parent[root] = other;
            root = other;
        } else
            parent[other] = root;
    }
}

/* A result that blames nothing that was given: success, or a lack of memory */
static gx_result gxp_end(gx_failure *failure, gx_result result) {
    if (failure != NULL) {
        failure->result = result;
        failure->field = NULL;
        failure->index = failure->surface = SIZE_MAX;
    }
    return result;
}

static GXP_COLD gx_result gxp_fail(gx_failure *failure, gx_result result, const char *field, size_t index) {
    gxp_end(failure, result);
    if (failure != NULL) failure->field = field, failure->index = index;
    return result;
}

static GXP_COLD gx_result gxp_refuse(gx_failure *failure, const char *field) {
    return gxp_fail(failure, GX_ERROR_ARGUMENT, field, SIZE_MAX);
}

/* Puts a result beside the field and index that were set when it came up, if any were since gxp_end. */
static gx_result gxp_close(gx_failure *failure, gx_result result) {
    if (failure != NULL) failure->result = result;
    return result;
}

static int gxp_is_finite(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return ((b >> 52) & 0x7ff) != 0x7ff;
}

static uint64_t gxp_mix(uint64_t x) { /* splitmix64's finaliser */
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* Hashes words of 8 bytes; the last one is filled up with zeros. */
static uint64_t gxp_hash_bytes(uint64_t hash, const unsigned char *bytes, size_t count) {
    uint64_t word;
    hash = gxp_mix(hash ^ count);
    for (; count >= sizeof word; count -= sizeof word, bytes += sizeof word) {
        memcpy(&word, bytes, sizeof word);
        hash = gxp_mix(hash ^ word);
    }
    word = 0;
    if (count > 0) memcpy(&word, bytes, count);
    return gxp_mix(hash ^ word);
}

static uint64_t gxp_hash_words(uint64_t hash, const uint32_t *words, size_t count) {
    size_t i;
    hash = gxp_mix(hash ^ count);
    for (i = 0; i < count; i++) hash = gxp_mix(hash ^ words[i]);
    return hash;
}

static uint64_t gxp_hash_doubles(uint64_t hash, const double *x, size_t count) {
    for (; count > 0; count--, x++) {
        uint64_t b;
        memcpy(&b, x, sizeof b);
        hash = gxp_mix(hash ^ b);
    }
    return hash;
}

/* texture: count x 2, or NULL */
static uint64_t gxp_hash_texture(uint64_t hash, const float *texture, size_t count) {
    size_t i;
    hash = gxp_mix(hash ^ (texture != NULL));
    for (i = 0; i < 2 * count && texture != NULL; i++) {
        uint32_t b;
        memcpy(&b, &texture[i], sizeof b);
        hash = gxp_mix(hash ^ b);
    }
    return hash;
}

static double gxp_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void gxp_cross(double r[3], const double a[3], const double b[3]) {
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scales n, of any length, to length 1. Returns 0 and leaves unit alone if n is zero or not finite. */
static int gxp_unit(const double n[3], double unit[3]) {
    double m[3] = {n[0], n[1], n[2]}, square = gxp_dot(n, n);
    int exponent, k;
    if (!gxp_is_finite(square) || square < 1e-280 || square > 1e280) {
        const double a = fabs(n[0]), b = fabs(n[1]), c = fabs(n[2]), most = a > b ? (a > c ? a : c) : b > c ? b : c;
        if (!gxp_is_finite(a) || !gxp_is_finite(b) || !gxp_is_finite(c) || !(most > 0)) return 0;
        (void)frexp(most, &exponent);
        for (k = 0; k < 3; k++) m[k] = ldexp(n[k], -exponent);
        square = gxp_dot(m, m);
    }
    square = 1 / sqrt(square);
    for (k = 0; k < 3; k++) unit[k] = square * m[k];
    return 1;
}

/* n = (b - a) x (c - a) of the triangle's corners */
static void gxp_triangle_normal(const double *x, const uint32_t *t, double n[3]) {
    const double *a = x + 3 * (size_t)t[0], *b = x + 3 * (size_t)t[1], *c = x + 3 * (size_t)t[2];
    const double p[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = p[1] * q[2] - p[2] * q[1];
    n[1] = p[2] * q[0] - p[0] * q[2];
    n[2] = p[0] * q[1] - p[1] * q[0];
}

static double gxp_square_distance(const double *a, const double *b) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return gxp_dot(d, d);
}

static double gxp_seconds(const gx_body *body) {
    return body->config.clock ? body->config.clock(body->config.clock_user) : 0;
}

/* >>mesh: elements, faces, nodes, boxes ---------------------------------------------------------------------------- */
/* Reads the mesh: which elements are around a node, what is behind a face, volumes, densities. In: the mesh that
   gx_body_create copied. Out: numbers, and at creation the tree of boxes over the elements (median split). Nothing here
   changes after the creation. */

/* Nodes of the face opposite to each node, counter-clockwise from outside */
static const uint8_t gxp_outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static const uint8_t gxp_edge_nodes[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static int gxp_local_node(const gx_body *body, uint32_t element, uint32_t node) {
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    return (n[0] == node) + 2 * (n[1] == node) + 3 * (n[2] == node) + 4 * (n[3] == node) - 1;
}

/* The local number of the element's node that is not on the face */
static uint32_t gxp_local_face(const gxb_complex *cx, uint32_t element, uint32_t face) {
    const uint32_t *faces = gxb_complex_element_faces(cx, element);
    return 3 - 3 * (uint32_t)(faces[0] == face) - 2 * (uint32_t)(faces[1] == face) - (uint32_t)(faces[2] == face);
}

static uint32_t gxp_neighbour(const gx_body *body, uint32_t element, uint32_t k) {
    const uint32_t face = gxb_complex_element_faces(body->complex, element)[k];
    const uint32_t *pair = gxb_complex_face_elements(body->complex, face);
    return pair[0] == element ? pair[1] : pair[0];
}

/* Returns an element with the face; *k: its node that is not on the face. */
static uint32_t gxp_face_element(const gxb_complex *cx, uint32_t face, uint32_t *k) {
    const uint32_t *pair = gxb_complex_face_elements(cx, face), element = pair[pair[0] == GXB_NONE];
    *k = gxp_local_face(cx, element, face);
    return element;
}

static void gxp_list_node_elements(gx_body *body) {
    const uint32_t *elements = gxb_complex_element_nodes(body->complex, 0);
    uint32_t i;
    memset(body->mesh.node_start, 0, ((size_t)body->mesh.node_count + 1) * sizeof *body->mesh.node_start);
    for (i = 0; i < 4 * body->mesh.element_count; i++) body->mesh.node_start[elements[i] + 1]++;
    for (i = 0; i < body->mesh.node_count; i++) body->mesh.node_start[i + 1] += body->mesh.node_start[i];
    for (i = 0; i < 4 * body->mesh.element_count; i++)
        body->mesh.node_elements[body->mesh.node_start[elements[i]]++] = i / 4;
    for (i = body->mesh.node_count; i > 0; i--) body->mesh.node_start[i] = body->mesh.node_start[i - 1];
    body->mesh.node_start[0] = 0;
}

static void gxp_element_positions(const gx_body *body, uint32_t element, double x[12]) {
    int k;
    for (k = 0; k < 4; k++)
        memcpy(x + 3 * k, body->mesh.positions + 3 * (size_t)gxb_complex_element_nodes(body->complex, element)[k],
               3 * sizeof *x);
}

static double gxp_element_volume(const gx_body *body, uint32_t element) {
    double x[12];
    gxp_element_positions(body, element, x);
    return gxi_tet_volume(x);
}

/* Is the element inverted in doubles, as the solver would see it, though it is not exactly? */
static int gxp_rounds_inverted(const gx_body *body, uint32_t element) {
    double x[12], gradients[12];
    gxp_element_positions(body, element, x);
    return gxi_tet_gradients(x, gradients, NULL) == GX_ERROR_INVERTED;
}

/* Coordinates are at most 2^GXP_REACH, the longest side is at least 2^-GXP_REACH. Masses of elements are 2^-GXP_WEIGHT
   ... 2^GXP_WEIGHT: the inertia of 2^28 of them is below 2^940. */
#define GXP_REACH  100
#define GXP_WEIGHT 700

static double gxp_density(const gx_body *body, const gxp_cell *cell) {
    return body->mesh.materials[cell->material].density;
}

static int gxp_is_mass(double mass) { return mass >= ldexp(1, -GXP_WEIGHT) && mass <= ldexp(1, GXP_WEIGHT); }

/* May there be interfaces? */
static int gxp_is_mixed(const gx_body *body) { return body->mesh.material_count > 1; }

static void gxp_box_of(const gx_body *body, gxp_box *box) {
    double low[3], high[3];
    uint32_t i;
    int k, n;
    for (i = box->first; i < box->first + box->count; i++)
        for (n = 0; n < 4; n++) {
            const double *x = body->mesh.positions +
                              3 * (size_t)gxb_complex_element_nodes(body->complex, body->mesh.box_elements[i])[n];
            for (k = 0; k < 3 && i == box->first && n == 0; k++) low[k] = high[k] = x[k];
            for (k = 0; k < 3; k++) {
                low[k] = x[k] < low[k] ? x[k] : low[k];
                high[k] = x[k] > high[k] ? x[k] : high[k];
            }
        }
    memcpy(box->low, low, sizeof low);
    memcpy(box->high, high, sizeof high);
}

static double gxp_element_key(const gx_body *body, uint32_t element, int axis) {
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    const double *x = body->mesh.positions + axis;
    return x[3 * (size_t)n[0]] * 0.25 + x[3 * (size_t)n[1]] * 0.25 + x[3 * (size_t)n[2]] * 0.25 +
           x[3 * (size_t)n[3]] * 0.25;
}

/* Partial order: puts the element of rank middle at middle and smaller keys before it (Hoare's FIND). */
static void gxp_select(const gx_body *body, uint32_t *e, int64_t count, int64_t middle, int axis) {
    int64_t low = 0, high = count - 1;
    while (low < high) {
        const double pivot = gxp_element_key(body, e[middle], axis);
        int64_t i = low, j = high;
        while (i <= j) {
            while (gxp_element_key(body, e[i], axis) < pivot) i++;
            while (gxp_element_key(body, e[j], axis) > pivot) j--;
            if (i <= j) {
                const uint32_t t = e[i];
                e[i++] = e[j];
                e[j--] = t;
            }
        }
        if (j < middle) low = i;
        if (middle < i) high = j;
    }
}

static void gxp_build_boxes(gx_body *body) {
    uint32_t i, b;
    for (i = 0; i < body->mesh.element_count; i++) body->mesh.box_elements[i] = i;
    memset(&body->mesh.boxes[0], 0, sizeof body->mesh.boxes[0]);
    body->mesh.boxes[0].count = body->mesh.element_count;
    body->mesh.box_count = 1;
    for (b = 0; b < body->mesh.box_count; b++) {
        gxp_box *box = &body->mesh.boxes[b];
        const uint32_t first = box->first, count = box->count, half = count / 2;
        int axis = 0, k;
        gxp_box_of(body, box);
        if (count <= 4) continue;
        for (k = 1; k < 3; k++)
            if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis]) axis = k;
        gxp_select(body, body->mesh.box_elements + first, count, half, axis);
        box->first = body->mesh.box_count;
        box->count = 0;
        memset(&body->mesh.boxes[body->mesh.box_count], 0, 2 * sizeof *body->mesh.boxes);
        body->mesh.boxes[body->mesh.box_count].first = first;
        body->mesh.boxes[body->mesh.box_count++].count = half;
        body->mesh.boxes[body->mesh.box_count].first = first + half;
        body->mesh.boxes[body->mesh.box_count++].count = count - half;
    }
}

/* >>search: the elements that a triangle may meet ------------------------------------------------------------------ */
/* In: a triangle. Out: a list of elements, all that the triangle meets and few others. Rounding adds candidates and
   never loses one. The complex decides exactly. */

/* A triangle whose elements are searched. Differences are multiplied by the frame's power of two, so that all products
   stay in range. */
typedef struct gxp_search {
    const double *base; /* its first corner */
    double unit, low[3], high[3];
    double axis[4][3]; /* the normal; of each edge the normal in the triangle's plane, outward */
    double scale[4];   /* size of the products that make up the axis */
    double offset[4];  /* of the triangle's plane and edges along the axes, from the base */
    /* size of the coordinates of this triangle and of any element: below 2^135, and heights are products of 7 such
     * numbers at most */
    double far;
} gxp_search;

/* Share of the terms' size, far above their rounding, so that rounding only adds candidates */
#define GXP_SEARCH_MARGIN 1e-12

static double gxp_size(const double a[3]) { return fabs(a[0]) + fabs(a[1]) + fabs(a[2]); }

/* axis = a x b. Returns the size of its terms. */
static double gxp_search_axis(const double a[3], const double b[3], double axis[3]) {
    axis[0] = a[1] * b[2] - a[2] * b[1];
    axis[1] = a[2] * b[0] - a[0] * b[2];
    axis[2] = a[0] * b[1] - a[1] * b[0];
    return gxp_size(a) * gxp_size(b);
}

/* d = (x - base) unit */
static void gxp_search_vector(const gxp_search *s, const double *x, double d[3]) {
    int k;
    for (k = 0; k < 3; k++) d[k] = (x[k] - s->base[k]) * s->unit;
}

/* all: the box around all elements */
static void gxp_search_init(gxp_search *s, const double *const p[3], double unit, const gxp_box *all) {
    double d[3][3], e[3];
    int i, k;
    s->base = p[0];
    s->unit = unit;
    for (i = 0; i < 3; i++) gxp_search_vector(s, p[i], d[i]);
    s->scale[0] = gxp_search_axis(d[1], d[2], s->axis[0]);
    s->offset[0] = 0;
    for (i = 1; i < 4; i++) {
        const double *from = d[i - 1], *to = d[i % 3];
        for (k = 0; k < 3; k++) e[k] = to[k] - from[k];
        gxp_search_axis(e, s->axis[0], s->axis[i]);
        s->scale[i] = gxp_size(e) * s->scale[0];
        s->offset[i] = s->axis[i][0] * from[0] + s->axis[i][1] * from[1] + s->axis[i][2] * from[2];
    }
    s->far = 0;
    for (k = 0; k < 3; k++) {
        s->low[k] = fmin(p[0][k], fmin(p[1][k], p[2][k]));
        s->high[k] = fmax(p[0][k], fmax(p[1][k], p[2][k]));
        s->far += 8 * (fabs(s->low[k]) + fabs(s->high[k]) + fabs(all->low[k]) + fabs(all->high[k])) * unit;
    }
}

/* May the triangle meet the box? The axes share one branch, since no one can predict which of them decides. */
static int gxp_triangle_near_box(const gxp_search *s, const gxp_box *box) {
    double sum = 0, r = 0;
    int k, beyond = 0;
    for (k = 0; k < 3; k++) {
        beyond |= s->low[k] > box->high[k];
        beyond |= s->high[k] < box->low[k];
    }
    if (beyond) return 0;
    for (k = 0; k < 3; k++) {
        const double c = 0.5 * box->low[k] + 0.5 * box->high[k], h = 0.5 * box->high[k] - 0.5 * box->low[k];
        sum += s->axis[0][k] * ((c - s->base[k]) * s->unit);
        r += fabs(s->axis[0][k]) * (h * s->unit);
    }
    return fabs(sum) <= r + GXP_SEARCH_MARGIN * s->scale[0] * s->far;
}

/* Heights of the element's nodes along an axis, and their largest error */
typedef struct gxp_heights {
    double at[4], margin;
} gxp_heights;

/* x: coordinates of the nodes from the base, by axis */
static void gxp_set_heights(const gxp_search *s, int i, double x[3][4], gxp_heights *h) {
    int n;
    for (n = 0; n < 4; n++)
        h->at[n] = s->axis[i][0] * x[0][n] + s->axis[i][1] * x[1][n] + s->axis[i][2] * x[2][n] - s->offset[i];
    h->margin = GXP_SEARCH_MARGIN * s->scale[i] * s->far;
}

/* Is the element's section with the triangle's plane beyond one of its edges? over: heights of the nodes above the
   plane; along: heights across the edge. Where an edge of the element crosses the plane, the height along is (along_i
   |over_j| + along_j |over_i|) / (|over_i| + |over_j|). */
static int gxp_section_is_beyond(const gxp_heights *over, const gxp_heights *along) {
    int i, j;
    for (i = 0; i < 4; i++) {
        if (fabs(over->at[i]) <= over->margin && !(along->at[i] > along->margin)) return 0;
        for (j = 0; j < i; j++) {
            const double p = fabs(over->at[i]), q = fabs(over->at[j]), sum = along->at[i] * q + along->at[j] * p;
            if ((over->at[i] > over->margin && over->at[j] > over->margin) ||
                (over->at[i] < -over->margin && over->at[j] < -over->margin))
                continue;
            if (!(sum > along->margin * (p + q) + over->margin * (fabs(along->at[i]) + fabs(along->at[j])))) return 0;
        }
    }
    return 1;
}

/* Least of four */
static double gxp_least(const double x[4]) {
    const double a = x[0] < x[1] ? x[0] : x[1], b = x[2] < x[3] ? x[2] : x[3];
    return a < b ? a : b;
}

/* Greatest of four */
static double gxp_greatest(const double x[4]) {
    const double a = x[0] > x[1] ? x[0] : x[1], b = x[2] > x[3] ? x[2] : x[3];
    return a > b ? a : b;
}

/* May the triangle meet the tetrahedron? It does not if a plane separates them: one across a coordinate axis, the
   triangle's own, or one through an edge of the triangle beyond which the tetrahedron's section lies. x: coordinates of
   its nodes, by axis; then from the triangle's base, times unit. */
static int gxp_triangle_near_tet(const gxp_search *s, double x[3][4]) {
    gxp_heights over, along;
    int i, n, beyond = 0;
    for (i = 0; i < 3; i++) {
        beyond |= gxp_greatest(x[i]) < s->low[i];
        beyond |= gxp_least(x[i]) > s->high[i];
    }
    if (beyond) return 0;
    for (i = 0; i < 3; i++)
        for (n = 0; n < 4; n++) x[i][n] = (x[i][n] - s->base[i]) * s->unit;
    gxp_set_heights(s, 0, x, &over);
    if (gxp_least(over.at) > over.margin || gxp_greatest(over.at) < -over.margin) return 0;
    for (i = 1; i < 4; i++) {
        gxp_set_heights(s, i, x, &along);
        if (gxp_least(along.at) > along.margin ||
            (gxp_greatest(along.at) > along.margin && gxp_section_is_beyond(&over, &along)))
            return 0;
    }
    return 1;
}

static int gxp_triangle_near_element(const gx_body *body, const gxp_search *s, uint32_t element) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, element);
    double x[3][4];
    int i, n;
    for (n = 0; n < 4; n++)
        for (i = 0; i < 3; i++) x[i][n] = body->mesh.positions[3 * (size_t)node[n] + (size_t)i];
    return gxp_triangle_near_tet(s, x);
}

/* Finds the elements that the triangle may meet. Elements in boxes that it may meet are listed first, so that their
   data can be prefetched before each is examined. */
static gx_result gxp_find_elements(gx_body *body, const double *const p[3], gxp_words *found) {
    const uint32_t *elements = gxb_complex_element_nodes(body->complex, 0);
    gxp_search search;
    uint32_t stack[128], depth = 0, count = 0, i, k;
    gx_result result = GX_OK;
    found->count = 0;
    gxp_search_init(&search, p, ldexp(1, gxb_complex_shift(body->complex)), &body->mesh.boxes[0]);
    stack[depth++] = 0;
    while (depth > 0 && result == GX_OK) {
        const gxp_box *box = &body->mesh.boxes[stack[--depth]];
        if (!gxp_triangle_near_box(&search, box)) continue;
        if (box->count == 0) {
            stack[depth++] = box->first + 1;
            stack[depth++] = box->first;
        } else
            result = gxp_words_room(body, found, box->count);
        for (i = 0; i < box->count && result == GX_OK; i++) {
            const uint32_t element = found->data[found->count++] = body->mesh.box_elements[box->first + i];
            GXP_PREFETCH(elements + 4 * (size_t)element);
        }
    }
    for (i = 0; i < found->count && result == GX_OK; i++) {
        for (k = 0; k < 4 && i + 4 < found->count; k++)
            GXP_PREFETCH(body->mesh.positions + 3 * (size_t)elements[4 * (size_t)found->data[i + 4] + k]);
        if (!gxp_triangle_near_element(body, &search, found->data[i])) continue;
        gxb_complex_prefetch_element(body->complex, found->data[i]);
        found->data[count++] = found->data[i];
    }
    found->count = count;
    return result;
}

/* >>copies: tables of copies, cells and leaves --------------------------------------------------------------------- */
/* In: the tables of copies and leaves. Out: a row for each new leaf, the state as a hash, copies that wake. Touches
   these tables only. */

/* The copy of a node that moves the cell */
static uint32_t gxp_copy_of(const gx_body *body, uint32_t cell, uint32_t node) {
    return body->cells.data[cell].copies[gxp_local_node(body, body->cells.data[cell].element, node)];
}

/* Walks through the cells that a copy moves. */
typedef struct gxp_around {
    uint32_t copy, at, cell;
} gxp_around;

static gxp_around gxp_around_copy(const gx_body *body, uint32_t copy) {
    gxp_around around;
    around.copy = copy;
    around.at = body->mesh.node_start[body->copies.node[copy]];
    around.cell = GXP_NONE;
    return around;
}

/* The next cell. Returns 0 if there are no more. */
static int gxp_next_around(const gx_body *body, gxp_around *around) {
    const uint32_t copy = around->copy, end = body->mesh.node_start[body->copies.node[copy] + 1];
    for (;;) {
        const gxp_cell *cell;
        if (around->cell != GXP_NONE) around->cell = body->cells.data[around->cell].next;
        if (around->cell == GXP_NONE && around->at == end) return 0;
        if (around->cell == GXP_NONE) around->cell = body->mesh.node_elements[around->at++];
        cell = &body->cells.data[around->cell];
        if (cell->kept &&
            (cell->copies[0] == copy || cell->copies[1] == copy || cell->copies[2] == copy || cell->copies[3] == copy))
            return 1;
    }
}

/* The cell of a slot, or GXP_NONE if its row is gone. */
static uint32_t gxp_cell_of_slot(const gx_body *body, uint32_t slot) {
    const uint32_t *name = body->cells.slot;
    uint32_t low = 0, high = body->cells.count;
    if (slot < high && name[slot] == slot) return slot;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (name[middle] < slot)
            low = middle + 1;
        else
            high = middle;
    }
    return low < body->cells.count && name[low] == slot ? low : GXP_NONE;
}

/* The cell of a slot that is below slots.count; GXP_NONE: it is removed. */
static uint32_t gxp_kept_cell(const gx_body *body, uint32_t slot) {
    const uint32_t cell = gxp_cell_of_slot(body, slot);
    return cell != GXP_NONE && body->cells.data[cell].kept ? cell : GXP_NONE;
}

/* The element of a slot: the first cell's slot is the first of its ancestors. */
static uint32_t gxp_slot_element(const gx_body *body, uint32_t slot) {
    while (body->slots.parent[slot] != slot) slot = body->slots.parent[slot];
    return slot;
}

/* Adds a row for each new leaf of the complex. It starts in its parent's cell, outside the cell's list. */
static gx_result gxp_follow_leaves(gx_body *body) {
    const uint32_t count = gxb_complex_leaf_count(body->complex);
    const gx_result result = gxp_grow_rows(body, GXP_LEAVES, count - body->leaves.count);
    if (result != GX_OK) return result;
    for (; body->leaves.count < count; body->leaves.count++) {
        gxp_leaf *leaf = &body->leaves.data[body->leaves.count];
        leaf->cell = body->leaves.data[gxb_complex_leaf(body->complex, body->leaves.count)->parent].cell;
        leaf->next = GXP_NONE;
    }
    return GX_OK;
}

static uint64_t gxp_hash_state(const gx_body *body, size_t copies) {
    return gxp_hash_doubles(gxp_hash_doubles(1, body->copies.displacement, 3 * copies), body->copies.velocity,
                            3 * copies) |
           1;
}

/* After saving, copying or reading, the solver has no previous step. If the state of the copies was written since then,
   wakes all of them, in a copy as in the original. */
static void gxp_wake_resumed(gx_body *body, size_t copies) {
    uint32_t i;
    if (body->model.resumed == 0 || body->model.resumed == gxp_hash_state(body, copies)) return;
    for (i = 0; i < body->copies.count; i++) body->copies.rest_time[i] = 0;
}

/* >>transaction: undoing a cut ------------------------------------------------------------------------------------- */
/* A cut changes cells and leaves in place and appends to other tables. The undo log, the counts at the cut's begin and
   the complex's own log take it back. Every change of a cell or leaf that the cut did not make goes through here first.
 */

/* A cut at work: the steps of gx_body_cut pass this on */
typedef struct gxp_cut {
    gx_body *body;
    const gx_cut_desc *desc;
    int shapes;                /* 1: the surfaces are a shape's; what lies in none of them goes, not in one */
    const gx_surface *stamped; /* whose slots bear the scope's stamp; NULL: the cells of the cut's scope do */
    gx_cut_report report;
    gx_failure failure;
} gxp_cut;

/* Room in a log for that many further rows */
static gx_result gxp_log_room(gx_body *body, gxp_log *log, size_t rows) {
    const size_t size = log->row_size;
    const gx_result result = gxp_words_room(body, &log->rows, rows);
    return result != GX_OK ? result
                           : gxp_reserve(&body->config.allocator, &log->bytes, 1, log->rows.count * size,
                                         &log->byte_capacity, rows * size);
}

/* Copies the undone columns of a row to bytes, or back from them. */
static void gxp_pass_undone(gx_body *body, uint32_t table, uint32_t row, unsigned char *bytes, int back) {
    const gxp_column *column = gxp_tables[table].columns, *end = column + gxp_tables[table].column_count;
    for (; column < end; column++) {
        unsigned char *item = (unsigned char *)gxp_array_at(body, column) + row * column->size;
        if (!(column->use & GXP_UNDONE)) continue;
        memcpy(back ? item : bytes, back ? bytes : item, column->size);
        bytes += column->size;
    }
}

static gx_result gxp_log_row(gx_body *body, gxp_log *log, uint32_t table, uint32_t row) {
    const gx_result result = gxp_log_room(body, log, 1);
    if (result != GX_OK) return result;
    gxp_pass_undone(body, table, row, log->bytes + log->rows.count * (size_t)log->row_size, 0);
    log->rows.data[log->rows.count++] = row;
    return GX_OK;
}

/* Puts logged rows back, the last one first. */
static void gxp_undo_rows(gx_body *body, gxp_log *log, uint32_t table) {
    while (log->rows.count > 0) {
        log->rows.count--;
        gxp_pass_undone(body, table, log->rows.data[log->rows.count],
                        log->bytes + log->rows.count * (size_t)log->row_size, 1);
    }
}

/* Logs a cell before it changes, unless this cut has logged or made it. */
static gx_result gxp_save_cell(gx_body *body, uint32_t cell) {
    gx_result result;
    if (body->cells.saved_by[cell] == body->undo.cut_number) return GX_OK;
    result = gxp_log_row(body, &body->undo.cells, GXP_CELLS, cell);
    if (result == GX_OK) body->cells.saved_by[cell] = body->undo.cut_number;
    return result;
}

/* Gives a leaf to a cell. Leaves that this cut made are not logged. */
static gx_result gxp_set_leaf(gx_body *body, uint32_t leaf, uint32_t cell, uint32_t next) {
    if (leaf < body->undo.counts[GXP_LEAVES]) {
        const gx_result result = gxp_log_row(body, &body->undo.leaves, GXP_LEAVES, leaf);
        if (result != GX_OK) return result;
    }
    body->leaves.data[leaf].cell = cell;
    body->leaves.data[leaf].next = next;
    return GX_OK;
}

static void gxp_begin(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_undo *undo = &body->undo;
    uint32_t t;
    gxb_complex_begin(body->complex);
    undo->cells.rows.count = undo->leaves.rows.count = 0;
    undo->cells.row_size = (uint32_t)gxp_row_size(GXP_CELLS, GXP_UNDONE);
    undo->leaves.row_size = (uint32_t)gxp_row_size(GXP_LEAVES, GXP_UNDONE);
    undo->cut_number++;
    for (t = 0; t < GXP_TABLES; t++) undo->counts[t] = *gxp_count_at(body, t);
    undo->labels = body->cuts.label_count;
    undo->dirty = body->skin.dirty.count;
    undo->splits = body->view.splits.count;
}

static void gxp_rollback(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_undo *undo = &body->undo;
    uint32_t t;
    gxp_undo_rows(body, &undo->cells, GXP_CELLS);
    gxp_undo_rows(body, &undo->leaves, GXP_LEAVES);
    for (t = 0; t < GXP_TABLES; t++) /* a cut appends to these, and makes others anew */
        if (gxp_row_size(t, GXP_TOPOLOGY) > 0) *gxp_count_at(body, t) = undo->counts[t];
    body->cuts.label_count = undo->labels;
    body->skin.dirty.count = undo->dirty;
    body->view.splits.count = undo->splits;
    gxb_complex_rollback(body->complex);
}

/* >>complex: reading the complex ----------------------------------------------------------------------------------- */
/* In: leaves, facets, edges and trees of the complex. Out: lists: points of leaves and facets, leaves below a tree, the
   undivided facets and edges that make up a divided one. Resolving such lists may renew them within the complex;
   nothing else changes. */

/* An entry of a list of the complex. Resolving a list may move the others, so no pointer into a list is kept. */
static uint32_t gxp_item(const gxb_complex *cx, uint32_t place) { return *gxb_complex_list(cx, place); }

static int gxp_is_kept(const gx_body *body, uint32_t leaf) {
    return leaf != GXB_NONE && !gxb_complex_leaf(body->complex, leaf)->removed;
}

/* Is the facet a link, or open inside an element? */
static int gxp_is_link(const gx_body *body, uint32_t facet) {
    const gxb_facet *f = gxb_complex_facet(body->complex, facet);
    return !f->wall && gxp_is_kept(body, f->leaf[0]) && gxp_is_kept(body, f->leaf[1]);
}

/* Collects the points of a leaf in scratch.leaf_points; points of several facets appear several times. */
static gx_result gxp_collect_leaf_points(gx_body *body, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    uint32_t first, count = 0, i, j, e0, en;
    gx_result result = gxb_complex_open_element(cx, gxb_complex_leaf(cx, leaf)->element);
    body->scratch.leaf_points.count = 0;
    if (result == GX_OK) result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxb_facet_resolve_edges(cx, gxp_item(cx, first + i), &e0, &en);
        for (j = 0; j < en && result == GX_OK; j++) {
            const uint32_t e = gxp_item(cx, e0 + j);
            result = gxp_push(body, &body->scratch.leaf_points, gxb_complex_edge_start(cx, e));
        }
    }
    return result;
}

/* Collects the corners of a facet in scratch.facet_points. */
static gx_result gxp_collect_facet_points(gx_body *body, uint32_t facet) {
    gxp_scratch *scratch = &body->scratch;
    gxb_complex *cx = body->complex;
    uint32_t e0, en, i;
    gx_result result = gxb_facet_resolve_edges(cx, facet, &e0, &en);
    scratch->facet_points.count = 0;
    if (result == GX_OK) result = gxp_words_room(body, &scratch->facet_points, en);
    for (i = 0; i < en && result == GX_OK; i++)
        scratch->facet_points.data[scratch->facet_points.count++] = gxb_complex_edge_start(cx, gxp_item(cx, e0 + i));
    return result;
}

/* Appends the leaves below a reference to an element's tree. */
static gx_result gxp_push_leaves(gx_body *body, uint32_t reference, gxp_words *out) {
    const gxb_node *node = gxb_complex_tree_node(body->complex, reference >> 1);
    gx_result result;
    if (!(reference & 1)) return gxp_push(body, out, reference >> 1);
    result = gxp_push_leaves(body, node->child[0], out);
    return result == GX_OK ? gxp_push_leaves(body, node->child[1], out) : result;
}

/* Appends the undivided edges that make up an edge of the complex. */
static gx_result gxp_push_divided_edges(gx_body *body, uint32_t edge, gxp_words *out) {
    const uint32_t child = gxb_complex_edge(body->complex, edge)->child;
    gx_result result;
    if (child == GXB_NONE) return gxp_push(body, out, edge);
    result = gxp_push_divided_edges(body, child, out);
    return result == GX_OK ? gxp_push_divided_edges(body, child + 1, out) : result;
}

/* Appends the undivided facets that make up a facet. */
static gx_result gxp_push_divided_facets(gx_body *body, uint32_t facet, gxp_words *out) {
    const uint32_t child = gxb_complex_facet(body->complex, facet)->child;
    gx_result result;
    if (child == GXB_NONE) return gxp_push(body, out, facet);
    result = gxp_push_divided_facets(body, child, out);
    return result == GX_OK ? gxp_push_divided_facets(body, child + 1, out) : result;
}

/* Appends the leaves on both sides of the undivided facets that make up a facet. */
static gx_result gxp_push_leaves_beside(gx_body *body, uint32_t facet, gxp_words *leaves) {
    const gxb_facet *f = gxb_complex_facet(body->complex, facet);
    gx_result result = GX_OK;
    if (f->child != GXB_NONE) {
        const uint32_t child = f->child;
        result = gxp_push_leaves_beside(body, child, leaves);
        return result == GX_OK ? gxp_push_leaves_beside(body, child + 1, leaves) : result;
    }
    if (f->leaf[0] != GXB_NONE) result = gxp_push(body, leaves, f->leaf[0]);
    if (f->leaf[1] != GXB_NONE && result == GX_OK) result = gxp_push(body, leaves, f->leaf[1]);
    return result;
}

/* Lists the leaves on both sides of the facets that this cut marked, or only of those that it made walls. */
static gx_result gxp_list_marked_leaves(gx_body *body, int walls, gxp_words *leaves) {
    const uint32_t count = gxb_complex_marked_count(body->complex);
    uint32_t i;
    gx_result result = gxp_start_words(body, leaves, 2 * (size_t)count);
    for (i = 0; i < count && result == GX_OK; i++)
        if (!walls || gxb_complex_marked_wall(body->complex, i))
            result = gxp_push_leaves_beside(body, gxb_complex_marked_facet(body->complex, i), leaves);
    return result;
}

/* Is the mesh edge divided? */
static int gxp_edge_is_divided(const gxb_complex *cx, uint32_t mesh_edge) {
    const uint32_t edge = gxb_complex_mesh_edge(cx, mesh_edge);
    return edge != GXB_NONE && gxb_complex_edge(cx, edge)->child != GXB_NONE;
}

/* Appends a cell unless this walk has met it. */
static gx_result gxp_visit_cell(gx_body *body, uint32_t cell, gxp_words *visited) {
    if (body->cells.stamp[cell] == body->scratch.stamp) return GX_OK;
    body->cells.stamp[cell] = body->scratch.stamp;
    return gxp_push(body, visited, cell);
}

/* >>numbering: cells and fragments as the caller sees them; scope -------------------------------------------------- */
/* In: cells and copies. Out: the kept cells by element, fragments numbered in the order of their first cells, valid
   until the next cut; the cells that a cut may touch, by a stamp. Touches the view's lists and stamps of cells. */

/* Lists the kept cells by element and unites the copies of each cell: cells that are linked share copies. */
static gx_result gxp_list_cells(gx_body *body) {
    gxp_view *view = &body->view;
    uint32_t e, cell, i;
    gx_result result;
    view->count = view->indices.count = 0;
    result = gxp_grow_rows(body, GXP_VIEW, body->cells.count);
    if (result == GX_OK) result = gxp_start_words(body, &view->copy_fragment, body->copies.count);
    if (result != GX_OK) return result;
    view->copy_fragment.count = body->copies.count;
    for (i = 0; i < body->copies.count; i++) view->copy_fragment.data[i] = i;
    for (e = 0; e < body->mesh.element_count; e++)
        for (cell = e; cell != GXP_NONE; cell = body->cells.data[cell].next) {
            const gxp_cell *c = &body->cells.data[cell];
            if (!c->kept) continue;
            view->volume[view->count] = c->volume;
            view->cell[view->count] = cell;
            view->slot[view->count] = body->cells.slot[cell];
            view->element[view->count] = e;
            if (view->material != NULL) view->material[view->count] = c->material;
            memcpy(view->copies + 4 * (size_t)view->count++, c->copies, sizeof c->copies);
            gxp_unite_all(view->copy_fragment.data, c->copies);
        }
    return GX_OK;
}

/* Numbers fragments in the order of their first cells. */
static gx_result gxp_number_fragments(gx_body *body) {
    gxp_view *view = &body->view;
    uint32_t i;
    gx_result result = gxp_start_words(body, &view->fragment_number, body->copies.count);
    if (result != GX_OK) return result;
    memset(view->fragment_number.data, 0xff, body->copies.count * sizeof *view->fragment_number.data);
    view->fragment_count = 0;
    for (i = 0; i < view->count; i++) {
        const uint32_t copy = gxp_find(view->copy_fragment.data, view->copies[4 * i]);
        if (view->fragment_number.data[copy] == GXP_NONE) view->fragment_number.data[copy] = view->fragment_count++;
        view->fragment[i] = view->fragment_number.data[copy];
    }
    return GX_OK;
}

/* The fragment of a cell; the view is up to date. */
static uint32_t gxp_cell_fragment(gx_body *body, uint32_t cell) {
    return body->view.fragment_number.data[gxp_find(body->view.copy_fragment.data, body->cells.data[cell].copies[0])];
}

/* Lists cells and fragments, if a cut has been. Volumes and masses are summed in gx_body_view only. */
static gx_result gxp_update_view(gx_body *body) {
    gxp_view *view = &body->view;
    gx_result result;
    if (!view->stale) return GX_OK;
    view->labels_known = 0;
    result = gxp_list_cells(body);
    if (result == GX_OK) result = gxp_number_fragments(body);
    if (result != GX_OK) return result;
    view->stale = 0;
    view->sums_stale = view->labels_known = 1;
    view->splits.count = 0;
    return GX_OK;
}

/* Lists the index of each kept cell, if that is not there; the view is up to date. */
static gx_result gxp_list_indices(gx_body *body) {
    gxp_view *view = &body->view;
    gx_result result;
    uint32_t i;
    if (view->indices.count > 0) return GX_OK;
    result = gxp_start_words(body, &view->indices, body->cells.count);
    if (result != GX_OK) return result;
    view->indices.count = body->cells.count;
    for (i = 0; i < view->count; i++) view->indices.data[view->cell[i]] = i;
    return GX_OK;
}

/* The leaf that contained this one before the cut */
static uint32_t gxp_old_leaf(const gx_body *body, uint32_t leaf) {
    while (leaf >= body->leaves.count) leaf = gxb_complex_leaf(body->complex, leaf)->parent;
    return leaf;
}

/* May the cut touch this leaf? It may if the cell that had it before the cut bears the scope's stamp. */
static int gxp_in_scope(void *user, uint32_t leaf) {
    const gx_body *body = (const gx_body *)user;
    return body->cells.stamp[body->leaves.data[gxp_old_leaf(body, leaf)].cell] == body->scratch.scope_stamp;
}

static int gxp_has_scope(const gx_cut_desc *desc) {
    return desc->scope_fragment_count > 0 || desc->scope_cell_count > 0;
}

/* Stamps the cells of the cut's scope, if it has one. */
static gx_result gxp_stamp_scope(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_view *view = &body->view;
    gxp_scratch *scratch = &body->scratch;
    const gx_cut_desc *desc = cut->desc;
    gx_result result;
    size_t i, j;
    cut->stamped = NULL;
    if (!gxp_has_scope(desc)) return GX_OK;
    result = gxp_update_view(body);
    if (result != GX_OK) return result;
    scratch->scope_stamp = ++scratch->stamp;
    for (i = 0; i < desc->scope_cell_count; i++) {
        if (desc->scope_cells[i] >= view->count) return gxp_fail(&cut->failure, GX_ERROR_INDEX, "scope_cells", i);
        body->cells.stamp[view->cell[desc->scope_cells[i]]] = scratch->scope_stamp;
    }
    for (i = 0; i < desc->scope_fragment_count; i++) {
        if (desc->scope_fragments[i] >= view->fragment_count)
            return gxp_fail(&cut->failure, GX_ERROR_INDEX, "scope_fragments", i);
        for (j = 0; j < view->count; j++)
            if (view->fragment[j] == desc->scope_fragments[i]) body->cells.stamp[view->cell[j]] = scratch->scope_stamp;
    }
    return GX_OK;
}

/* Stamps the cells that a surface may touch, unless they bear the stamp. *scoped: 0 if these are all. */
static gx_result gxp_stamp_surface(gxp_cut *cut, const gx_surface *s, int *scoped) {
    gx_body *body = cut->body;
    size_t i;
    *scoped = s->scope_slots != NULL || gxp_has_scope(cut->desc);
    if (cut->stamped == (s->scope_slots != NULL ? s : NULL)) return GX_OK;
    if (s->scope_slots == NULL) return gxp_stamp_scope(cut);
    body->scratch.scope_stamp = ++body->scratch.stamp;
    for (i = 0; i < s->scope_slot_count; i++) {
        const uint32_t cell = gxp_kept_cell(body, s->scope_slots[i]);
        if (cell != GXP_NONE) body->cells.stamp[cell] = body->scratch.scope_stamp;
    }
    cut->stamped = s;
    return GX_OK;
}

/* >>surfaces: the surfaces of a cut -------------------------------------------------------------------------------- */
/* In: a surface as the caller gave it. Out: the same, checked, with equal vertices merged, edges sorted and triangles
   without area marked; a record of it for the skin. Touches the body's records of surfaces. */

typedef struct gxp_half_edge {
    uint32_t from, to, triangle, corner;
} gxp_half_edge;

static int gxp_compare_half_edges(const void *a, const void *b) {
    const gxp_half_edge *p = (const gxp_half_edge *)a, *q = (const gxp_half_edge *)b;
    const uint32_t pl = p->from < p->to ? p->from : p->to, ph = p->from < p->to ? p->to : p->from;
    const uint32_t ql = q->from < q->to ? q->from : q->to, qh = q->from < q->to ? q->to : q->from;
    if (pl != ql) return pl < ql ? -1 : 1;
    if (ph != qh) return ph < qh ? -1 : 1;
    return p->triangle != q->triangle ? p->triangle < q->triangle ? -1 : 1 : 0;
}

typedef struct gxp_named_point {
    double x[3];
    uint32_t index;
} gxp_named_point;

static int gxp_compare_points(const void *a, const void *b) {
    const gxp_named_point *p = (const gxp_named_point *)a, *q = (const gxp_named_point *)b;
    int k;
    for (k = 0; k < 3; k++)
        if (p->x[k] != q->x[k]) return p->x[k] < q->x[k] ? -1 : 1;
    return p->index != q->index ? p->index < q->index ? -1 : 1 : 0;
}

/* A surface during the cut: its triangles, its vertices and planes in the complex, its edges */
typedef struct gxp_surface {
    const gx_surface *given;
    size_t number;           /* among the cut's surfaces */
    uint32_t label;          /* of its first triangle */
    uint32_t *point;         /* vertex_count: in the complex, or GXP_NONE */
    gxb_triangle *triangles; /* triangle_count; plane GXP_NONE: not in the complex yet */
    uint8_t *flat;           /* triangle_count: no area */
    gxp_half_edge *edges;    /* 3 x triangle_count, sorted: edges with the same ends stand together */
    uint32_t *merged;        /* vertex_count: the first vertex with the same coordinates */
    double low[3], high[3];  /* of its vertices */
} gxp_surface;

static void gxp_surface_free(gx_body *body, gxp_surface *s) {
    const size_t v = s->given->vertex_count, t = s->given->triangle_count;
    gxp_release(&body->config.allocator, s->point, v * sizeof *s->point);
    gxp_release(&body->config.allocator, s->triangles, t * sizeof *s->triangles);
    gxp_release(&body->config.allocator, s->flat, t);
    gxp_release(&body->config.allocator, s->edges, 3 * t * sizeof *s->edges);
    gxp_release(&body->config.allocator, s->merged, v * sizeof *s->merged);
}

static gx_result gxp_check_surface_arrays(const gx_surface *s, gx_failure *failure) {
    if (s->kind > GX_SURFACE_MATERIAL) return gxp_refuse(failure, "surfaces.kind");
    if (s->vertex_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "surfaces.vertex_count", SIZE_MAX);
    if (s->triangle_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "surfaces.triangle_count", SIZE_MAX);
    if (s->vertices == NULL) return gxp_refuse(failure, "surfaces.vertices");
    if (s->triangles == NULL) return gxp_refuse(failure, "surfaces.triangles");
    if (s->vertex_count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "surfaces.vertex_count", SIZE_MAX);
    if (s->triangle_count > INT32_MAX / 4)
        return gxp_fail(failure, GX_ERROR_LIMIT, "surfaces.triangle_count", SIZE_MAX);
    return GX_OK;
}

static gx_result gxp_check_slots(const gx_body *body, const gx_surface *s, gx_failure *failure) {
    size_t i;
    if (s->scope_slot_count > 0 && s->scope_slots == NULL) return gxp_refuse(failure, "surfaces.scope_slots");
    for (i = 0; i < s->scope_slot_count; i++)
        if (s->scope_slots[i] >= body->slots.count) return gxp_fail(failure, GX_ERROR_INDEX, "surfaces.scope_slots", i);
    return GX_OK;
}

static gx_result gxp_check_surface(const gx_body *body, const gx_surface *s, gx_failure *failure) {
    gx_result result = gxp_check_surface_arrays(s, failure);
    size_t i;
    if (result == GX_OK) result = gxp_check_slots(body, s, failure);
    if (result == GX_OK && s->kind == GX_SURFACE_MATERIAL && s->material >= body->mesh.material_count)
        result = gxp_fail(failure, GX_ERROR_INDEX, "surfaces.material", SIZE_MAX);
    for (i = 0; i < s->vertex_count && result == GX_OK; i++) {
        result = gxb_complex_check_point(body->complex, s->vertices + 3 * i);
        if (result != GX_OK) return gxp_fail(failure, result, "surfaces.vertices", i);
        if (s->texture != NULL &&
            (!gxp_is_finite((double)s->texture[2 * i]) || !gxp_is_finite((double)s->texture[2 * i + 1])))
            return gxp_fail(failure, GX_ERROR_NOT_FINITE, "surfaces.texture", i);
    }
    for (i = 0; i < 3 * s->triangle_count && result == GX_OK; i++)
        if (s->triangles[i] >= s->vertex_count) result = gxp_fail(failure, GX_ERROR_INDEX, "surfaces.triangles", i / 3);
    return result;
}

/* A triangle has no area if all its projections to coordinate planes have none. */
static int gxp_is_flat(const double *a, const double *b, const double *c) {
    int k;
    for (k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        double p[2], q[2], r[2];
        p[0] = a[i];
        p[1] = a[j];
        q[0] = b[i];
        q[1] = b[j];
        r[0] = c[i];
        r[1] = c[j];
        if (gxb_orient2d(p, q, r) != 0) return 0;
    }
    return 1;
}

/* Finds for each vertex the first one with the same coordinates. */
static gx_result gxp_merge_vertices(gx_body *body, gxp_surface *s) {
    const size_t n = s->given->vertex_count;
    gxp_named_point *named = (gxp_named_point *)gxp_allocate(&body->config.allocator, n * sizeof *named);
    size_t i;
    if (named == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < n; i++) {
        memcpy(named[i].x, s->given->vertices + 3 * i, sizeof named[i].x);
        named[i].index = (uint32_t)i;
    }
    qsort(named, n, sizeof *named, gxp_compare_points);
    for (i = 0; i < n; i++) {
        const int same = i > 0 && named[i].x[0] == named[i - 1].x[0] && named[i].x[1] == named[i - 1].x[1] &&
                         named[i].x[2] == named[i - 1].x[2];
        s->merged[named[i].index] = same ? s->merged[named[i - 1].index] : named[i].index;
    }
    gxp_release(&body->config.allocator, named, n * sizeof *named);
    return GX_OK;
}

/* Sorts the half-edges, so that those with the same ends stand together. */
static void gxp_sort_edges(gxp_surface *s) {
    uint32_t t, k;
    for (t = 0; t < s->given->triangle_count; t++)
        for (k = 0; k < 3; k++) {
            gxp_half_edge *e = &s->edges[3 * t + k];
            e->from = s->merged[s->given->triangles[3 * t + k]];
            e->to = s->merged[s->given->triangles[3 * t + (k + 1) % 3]];
            e->triangle = t;
            e->corner = k;
        }
    qsort(s->edges, 3 * s->given->triangle_count, sizeof *s->edges, gxp_compare_half_edges);
}

static int gxp_same_ends(const gxp_half_edge *a, const gxp_half_edge *b) {
    return (a->from == b->from && a->to == b->to) || (a->from == b->to && a->to == b->from);
}

/* A surface has no boundary if at each edge equally many triangles run one way and the other. */
static gx_result gxp_check_closed(gxp_cut *cut, const gxp_surface *s) {
    const size_t n = 3 * s->given->triangle_count;
    size_t i, j;
    for (i = 0; i < n; i = j) {
        long balance = 0;
        for (j = i; j < n && gxp_same_ends(&s->edges[i], &s->edges[j]); j++)
            balance += s->edges[j].from < s->edges[j].to ? 1 : s->edges[j].from > s->edges[j].to ? -1 : 0;
        if (balance != 0) {
            gxp_fail(&cut->failure, GX_ERROR_NOT_CLOSED, "surfaces.triangles", s->edges[i].triangle);
            cut->failure.surface = s->number;
            return GX_ERROR_NOT_CLOSED;
        }
    }
    return GX_OK;
}

/* The affine map from material coordinates (less the complex's origin) to the texture of one triangle. With edges p and
   q and n = p x q, the share of p in x - a is g . (x - a), g = (q x n) / |n|^2; that of q has (n x p) / |n|^2. */
static void gxp_map_triangle(const gx_body *body, const gx_surface *s, size_t triangle, double map[8]) {
    const uint32_t *t = s->triangles + 3 * triangle;
    const double *a = s->vertices + 3 * (size_t)t[0], *b = s->vertices + 3 * (size_t)t[1],
                 *c = s->vertices + 3 * (size_t)t[2];
    double p[3], q[3], n[3], square = 0;
    int i, k;
    for (k = 0; k < 3; k++) {
        p[k] = b[k] - a[k];
        q[k] = c[k] - a[k];
    }
    for (k = 0; k < 3; k++) n[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    for (k = 0; k < 3; k++) square += n[k] * n[k];
    for (i = 0; i < 2; i++) {
        const double u = (double)s->texture[2 * t[0] + (uint32_t)i],
                     du = (double)s->texture[2 * t[1] + (uint32_t)i] - u,
                     dv = (double)s->texture[2 * t[2] + (uint32_t)i] - u;
        map[4 * i + 3] = u;
        for (k = 0; k < 3; k++) {
            const int x = (k + 1) % 3, y = (k + 2) % 3;
            const double g = q[x] * n[y] - q[y] * n[x], h = n[x] * p[y] - n[y] * p[x];
            map[4 * i + k] = square > 0 ? (du * g + dv * h) / square : 0;
            /* fourth powers of its sizes are beyond doubles */
            if (!gxp_is_finite(map[4 * i + k])) map[4 * i + k] = 0;
            map[4 * i + 3] -= map[4 * i + k] * (a[k] - gxb_complex_origin(body->complex)[k]);
        }
    }
}

/* Records a surface that begins to cut: where its labels start, and the maps to its texture. */
static gx_result gxp_note_surface(gx_body *body, const gx_surface *given) {
    const size_t maps = given->texture != NULL ? given->triangle_count : 0;
    gxp_cuts *cuts = &body->cuts;
    gx_result result = gxp_grow_rows(body, GXP_SURFACES, 1);
    uint32_t i;
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_MAPS, maps);
    if (result != GX_OK) return result;
    cuts->surfaces[cuts->surface_count].label = cuts->label_count;
    cuts->surfaces[cuts->surface_count++].map = maps > 0 ? cuts->map_count : GXP_NONE;
    for (i = 0; i < maps; i++) gxp_map_triangle(body, given, i, cuts->maps + 8 * (size_t)cuts->map_count++);
    return GX_OK;
}

/* Prepares a surface for the cut; checks that a solid is closed. gxp_surface_free frees it, also after an
   error. */
static gx_result gxp_surface_open(gxp_cut *cut, gxp_surface *s, const gx_surface *given, size_t number) {
    gx_body *body = cut->body;
    const size_t v = given->vertex_count, t = given->triangle_count;
    gx_result result;
    size_t i;
    memset(s, 0, sizeof *s);
    s->given = given;
    s->number = number;
    s->label = body->cuts.label_count;
    if (t > INT32_MAX - (size_t)body->cuts.label_count) return GX_ERROR_LIMIT;
    result = gxp_note_surface(body, given);
    if (result != GX_OK) return result;
    body->cuts.label_count += (uint32_t)t;
    s->point = (uint32_t *)gxp_allocate(&body->config.allocator, v * sizeof *s->point);
    s->triangles = (gxb_triangle *)gxp_allocate(&body->config.allocator, t * sizeof *s->triangles);
    s->flat = (uint8_t *)gxp_allocate(&body->config.allocator, t);
    s->edges = (gxp_half_edge *)gxp_allocate(&body->config.allocator, 3 * t * sizeof *s->edges);
    s->merged = (uint32_t *)gxp_allocate(&body->config.allocator, v * sizeof *s->merged);
    if (!s->point || !s->triangles || !s->flat || !s->edges || !s->merged) return GX_ERROR_MEMORY;
    memset(s->point, 0xff, v * sizeof *s->point);
    memcpy(s->low, given->vertices, sizeof s->low);
    memcpy(s->high, given->vertices, sizeof s->high);
    for (i = 3; i < 3 * v; i++) {
        const double x = given->vertices[i];
        if (x < s->low[i % 3]) s->low[i % 3] = x;
        if (x > s->high[i % 3]) s->high[i % 3] = x;
    }
    for (i = 0; i < t; i++) {
        const uint32_t *n = given->triangles + 3 * i;
        s->triangles[i].plane = GXP_NONE;
        s->flat[i] = (uint8_t)gxp_is_flat(given->vertices + 3 * (size_t)n[0], given->vertices + 3 * (size_t)n[1],
                                          given->vertices + 3 * (size_t)n[2]);
        cut->report.ignored_triangles += s->flat[i];
    }
    result = gxp_merge_vertices(body, s);
    if (result != GX_OK) return result;
    gxp_sort_edges(s);
    return given->kind != GX_SURFACE_SHEET ? gxp_check_closed(cut, s) : GX_OK;
}

/* >>pinches: elements that meet in a node or an edge only ---------------------------------------------------------- */
/* Where elements do not hang together through faces around a node or edge, that node or edge joins the cells around it,
   unless a wall touches it. In: the mesh, at creation; a triangle or a cell, at a cut. Out: which nodes and edges are
   pinched; marks in the complex where a sheet separates what meets there only; the cells that a joint joins. */

/* Lists the elements that faces through the node connect to the first one. */
static gx_result gxp_walk_around(gx_body *body, uint32_t start, uint32_t node, gxp_words *elements) {
    gx_result result = GX_OK;
    uint32_t done = 0;
    elements->count = 0;
    body->cells.stamp[start] = body->scratch.stamp;
    result = gxp_push(body, elements, start);
    while (done < elements->count && result == GX_OK) {
        const uint32_t e = elements->data[done++];
        uint32_t k;
        for (k = 0; k < 4 && result == GX_OK; k++) {
            const uint32_t other = gxp_neighbour(body, e, k), opposite = gxb_complex_element_nodes(body->complex, e)[k];
            if (other == GXP_NONE || body->cells.stamp[other] == body->scratch.stamp || opposite == node) continue;
            body->cells.stamp[other] = body->scratch.stamp;
            result = gxp_push(body, elements, other);
        }
    }
    return result;
}

/* Marks the nodes whose elements are not all connected by faces through the node. */
static gx_result gxp_find_pinched_nodes(gx_body *body) {
    gxp_words reached = {NULL, 0, 0};
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < body->mesh.node_count && result == GX_OK; i++) {
        const uint32_t first = body->mesh.node_start[i], count = body->mesh.node_start[i + 1] - first;
        if (count == 0) continue;
        body->scratch.stamp++;
        result = gxp_walk_around(body, body->mesh.node_elements[first], i, &reached);
        if (result == GX_OK && reached.count != count) body->mesh.node_pinched[i] = GXP_NODE_PINCHED;
    }
    gxp_release(&body->config.allocator, reached.data, reached.capacity * sizeof *reached.data);
    return result;
}

/* Marks the edges whose elements are not all connected by faces through the edge, and their nodes. The elements around
   an edge form as many fans as the edge has pairs of boundary faces; one fan has none or two of these faces. */
static void gxp_find_pinched_edges(gx_body *body) {
    const gxb_complex *cx = body->complex;
    uint32_t i, j, k;
    for (i = 0; i < body->mesh.element_count; i++)
        for (k = 0; k < 4; k++)
            for (j = 0; j < 6; j++) {
                const uint32_t edge = gxb_complex_element_edges(cx, i)[j];
                if (gxp_neighbour(body, i, k) != GXP_NONE || gxp_edge_nodes[j][0] == k || gxp_edge_nodes[j][1] == k)
                    continue;
                if (body->mesh.edge_pinched[edge] < 3) body->mesh.edge_pinched[edge]++;
            }
    for (i = 0; i < body->mesh.edge_count; i++) body->mesh.edge_pinched[i] = body->mesh.edge_pinched[i] > 2;
    for (i = 0; i < body->mesh.element_count; i++)
        for (j = 0; j < 6; j++) {
            if (!body->mesh.edge_pinched[gxb_complex_element_edges(cx, i)[j]]) continue;
            body->mesh.node_pinched[gxb_complex_element_nodes(cx, i)[gxp_edge_nodes[j][0]]] |= GXP_EDGE_PINCHED;
            body->mesh.node_pinched[gxb_complex_element_nodes(cx, i)[gxp_edge_nodes[j][1]]] |= GXP_EDGE_PINCHED;
        }
}

/* Where a word is in an ascending list, GXP_NONE: nowhere */
static uint32_t gxp_place_of(const gxp_words *words, uint32_t value) {
    uint32_t low = 0, high = words->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (words->data[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low < words->count && words->data[low] == value ? low : GXP_NONE;
}

/* Makes the edges in scratch.joint_edges joints: the parts of mesh edges in which elements meet, joints 0, 1, ... in
   ascending order. The joint after them is a node. */
static gx_result gxp_start_joints(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    gx_result result;
    gxp_sort_unique(&scratch->joint_edges);
    result = gxp_start_words(body, &scratch->joint_walls, (size_t)scratch->joint_edges.count + 1);
    if (result != GX_OK) return result;
    scratch->joint_walls.count = scratch->joint_edges.count + 1;
    memset(scratch->joint_walls.data, 0, scratch->joint_walls.count * sizeof *scratch->joint_walls.data);
    return GX_OK;
}

/* Lists in scratch.leaf_joints the joints on the boundary of a leaf of an open element, and notes in
   scratch.joint_walls at which a wall touches it. node: that is a joint, or GXB_NONE */
static gx_result gxp_find_leaf_joints(gx_body *body, uint32_t leaf, uint32_t node) {
    gxb_complex *cx = body->complex;
    gxp_scratch *scratch = &body->scratch;
    uint32_t first, count = 0, i, j, k, e0, en;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    scratch->leaf_joints.count = 0;
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = gxp_item(cx, first + i);
        const int wall = gxb_complex_facet(cx, facet)->wall != 0 || gxb_complex_leaf(cx, leaf)->removed != 0;
        result = gxb_facet_resolve_edges(cx, facet, &e0, &en);
        for (j = 0; j < en && result == GX_OK; j++) {
            const uint32_t e = gxp_item(cx, e0 + j);
            uint32_t joints[2] = {GXP_NONE, GXP_NONE};
            joints[0] = gxp_place_of(&scratch->joint_edges, e >> 1);
            if (node != GXB_NONE && gxb_complex_edge_start(cx, e) == node) joints[1] = scratch->joint_edges.count;
            for (k = 0; k < 2 && result == GX_OK; k++) {
                if (joints[k] == GXP_NONE) continue;
                result = gxp_push(body, &scratch->leaf_joints, joints[k]);
                if (wall || (k == 0 ? gxb_complex_edge(cx, e >> 1)->wall : gxb_complex_point(cx, node)->wall) != 0)
                    scratch->joint_walls.data[joints[k]] = 1;
            }
        }
    }
    gxp_sort_unique(&scratch->leaf_joints);
    return result;
}

/* Is the node, or any part of the mesh edge, on the boundary of a leaf of the element that the cut may touch? The other
   of the two is GXB_NONE. */
static gx_result gxp_is_joint_in_scope(gx_body *body, uint32_t element, uint32_t node, uint32_t edge, int *found) {
    gxp_scratch *scratch = &body->scratch;
    gx_result result;
    uint32_t i;
    *found = 0;
    scratch->joint_leaves.count = scratch->joint_edges.count = 0;
    result = gxb_complex_open_element(body->complex, element);
    if (edge != GXB_NONE && result == GX_OK)
        result = gxp_push_divided_edges(body, gxb_complex_mesh_edge(body->complex, edge), &scratch->joint_edges);
    if (result == GX_OK) result = gxp_start_joints(body);
    if (result == GX_OK)
        result = gxp_push_leaves(body, gxb_complex_root(body->complex, element), &scratch->joint_leaves);
    for (i = 0; i < scratch->joint_leaves.count && result == GX_OK && !*found; i++) {
        if (!gxp_in_scope(body, scratch->joint_leaves.data[i])) continue;
        result = gxp_find_leaf_joints(body, scratch->joint_leaves.data[i], node);
        *found = scratch->leaf_joints.count > 0;
    }
    return result;
}

/* A sheet through a pinched node or edge separates the elements that meet there, even if it enters none of them. */
static gx_result gxp_cover_pinches(gx_body *body, gxb_triangle *t, uint32_t element, int scoped) {
    const gxb_complex *cx = body->complex;
    uint32_t k, pinched = 0;
    gx_result result = GX_OK;
    for (k = 0; k < 4; k++) pinched |= body->mesh.node_pinched[gxb_complex_element_nodes(cx, element)[k]];
    if (!pinched) return GX_OK;
    for (k = 0; k < 4 && result == GX_OK; k++) {
        const uint32_t node = gxb_complex_element_nodes(cx, element)[k];
        int covered = 0, allowed = 1;
        if (!(body->mesh.node_pinched[node] & 1)) continue;
        if (scoped) result = gxp_is_joint_in_scope(body, element, node, GXB_NONE, &allowed);
        if (result == GX_OK && allowed) result = gxb_complex_cover_node(body->complex, t, node, &covered);
        if (covered && result == GX_OK) result = gxp_push(body, &body->scratch.pinches, node);
    }
    for (k = 0; k < 6 && result == GX_OK; k++) {
        int covered = 0, allowed = 1;
        if (!body->mesh.edge_pinched[gxb_complex_element_edges(cx, element)[k]]) continue;
        if (scoped)
            result =
                gxp_is_joint_in_scope(body, element, GXB_NONE, gxb_complex_element_edges(cx, element)[k], &allowed);
        if (result == GX_OK && allowed) result = gxb_complex_cover_edge(body->complex, t, element, k, &covered);
        if (covered && result == GX_OK)
            result =
                gxp_push(body, &body->scratch.pinches, gxb_complex_element_nodes(cx, element)[gxp_edge_nodes[k][0]]);
        if (covered && result == GX_OK)
            result =
                gxp_push(body, &body->scratch.pinches, gxb_complex_element_nodes(cx, element)[gxp_edge_nodes[k][1]]);
    }
    return result;
}

/* Drops keys that are there twice; they are ascending. */
static void gxp_drop_same_keys(gxp_keys *keys) {
    uint32_t i, n = 0;
    for (i = 0; i < keys->count; i++)
        if (n == 0 || keys->data[i] != keys->data[n - 1]) keys->data[n++] = keys->data[i];
    keys->count = n;
}

/* Lists the pinched edges of a node, in parts, in scratch.joint_edges, and the leaves around it in joint_leaves. */
static gx_result gxp_list_joint_edges(gx_body *body, uint32_t node) {
    gxp_scratch *scratch = &body->scratch;
    gxb_complex *cx = body->complex;
    uint32_t i, k;
    gx_result result = GX_OK;
    scratch->joint_leaves.count = scratch->joint_edges.count = 0;
    for (i = body->mesh.node_start[node]; i < body->mesh.node_start[node + 1] && result == GX_OK; i++) {
        const uint32_t element = body->mesh.node_elements[i], *nodes = gxb_complex_element_nodes(cx, element);
        result = gxb_complex_open_element(cx, element);
        if (result == GX_OK) result = gxp_push_leaves(body, gxb_complex_root(cx, element), &scratch->joint_leaves);
        for (k = 0; k < 6 && result == GX_OK; k++) {
            const uint32_t edge = gxb_complex_element_edges(cx, element)[k];
            if (!body->mesh.edge_pinched[edge]) continue;
            if (nodes[gxp_edge_nodes[k][0]] == node || nodes[gxp_edge_nodes[k][1]] == node)
                result = gxp_push_divided_edges(body, gxb_complex_mesh_edge(cx, edge), &scratch->joint_edges);
        }
    }
    return result == GX_OK ? gxp_start_joints(body) : result;
}

/* Lists which cells around a node meet in which joints: the node, if it is pinched, and its pinched edges. Removed
   leaves count as walls. */
static gx_result gxp_list_joints(gx_body *body, uint32_t node) {
    gxp_scratch *scratch = &body->scratch;
    const uint32_t point = body->mesh.node_pinched[node] & 1 ? node : GXB_NONE;
    uint32_t i, k;
    gx_result result = gxp_list_joint_edges(body, node);
    scratch->joint_cells.count = scratch->cell_joints.count = 0;
    for (i = 0; i < scratch->joint_leaves.count && result == GX_OK; i++) {
        const uint32_t leaf = scratch->joint_leaves.data[i];
        result = gxp_find_leaf_joints(body, leaf, point);
        if (gxb_complex_leaf(body->complex, leaf)->removed) continue;
        for (k = 0; k < scratch->leaf_joints.count && result == GX_OK; k++)
            result =
                gxp_push_key(body, &scratch->joint_cells, scratch->leaf_joints.data[k], body->leaves.data[leaf].cell);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, &scratch->joint_cells, 0, scratch->joint_cells.count);
    gxp_drop_same_keys(&scratch->joint_cells);
    for (i = 0; i < scratch->joint_cells.count && result == GX_OK; i++)
        result = gxp_push_key(body, &scratch->cell_joints, GXP_SECOND(scratch->joint_cells.data[i]),
                              GXP_FIRST(scratch->joint_cells.data[i]));
    return result == GX_OK ? gxp_sort_keys(body, &scratch->cell_joints, 0, scratch->cell_joints.count) : result;
}

/* Visits the cells that joints connect to this one: those that gxp_list_joints has listed. */
static gx_result gxp_cross_joints(gx_body *body, uint32_t cell) {
    gxp_scratch *scratch = &body->scratch;
    const gxp_keys *of_cell = &scratch->cell_joints, *of_joint = &scratch->joint_cells;
    uint32_t i = gxp_first_key(of_cell, (uint64_t)cell << 32), j;
    gx_result result = GX_OK;
    for (; i < of_cell->count && GXP_FIRST(of_cell->data[i]) == cell; i++) {
        const uint32_t joint = GXP_SECOND(of_cell->data[i]);
        if (scratch->joint_walls.data[joint]) continue;
        j = gxp_first_key(of_joint, (uint64_t)joint << 32);
        for (; j < of_joint->count && GXP_FIRST(of_joint->data[j]) == joint && result == GX_OK; j++)
            result = gxp_visit_cell(body, GXP_SECOND(of_joint->data[j]), &scratch->subdomain_cells);
    }
    return result;
}

/* Adds the pinched nodes of the pairs to the nodes at which walls may break joints, and sorts these. */
static gx_result gxp_add_pinches(gx_body *body, const gxp_keys *pairs) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < pairs->count && result == GX_OK; i++)
        if (body->mesh.node_pinched[GXP_FIRST(pairs->data[i])])
            result = gxp_push(body, &body->scratch.pinches, GXP_FIRST(pairs->data[i]));
    gxp_sort_unique(&body->scratch.pinches);
    return result;
}

/* >>arrange: the surfaces go into the complex ---------------------------------------------------------------------- */
/* In: an opened surface. Out: its triangles in the complex, element by element, where they make walls or, of a solid,
   leave their labels. Touches the complex, and the list of nodes at which a sheet covers a pinch. */

/* Takes over the plane of a coplanar neighbour across an edge. Returns 0 if there is none. */
static int gxp_borrow_plane(gx_body *body, gxp_surface *s, uint32_t t) {
    gxb_triangle *own = &s->triangles[t];
    const size_t n = 3 * s->given->triangle_count;
    uint32_t k;
    for (k = 0; k < 3; k++) {
        gxp_half_edge key, *e;
        key.from = s->merged[s->given->triangles[3 * t + k]];
        key.to = s->merged[s->given->triangles[3 * t + (k + 1) % 3]];
        key.triangle = t;
        key.corner = k;
        e = (gxp_half_edge *)bsearch(&key, s->edges, n, sizeof *s->edges, gxp_compare_half_edges);
        if (e == NULL) continue;
        while (e > s->edges && gxp_same_ends(e - 1, e)) e--;
        for (; e < s->edges + n && gxp_same_ends(e, &key); e++) {
            const gxb_triangle *other = &s->triangles[e->triangle];
            if (e->triangle == t || other->plane == GXP_NONE || s->flat[e->triangle]) continue;
            if (gxb_complex_side(body->complex, own->point[(k + 2) % 3], other->plane) != 0) continue;
            own->plane = other->plane;
            own->orientation = 0; /* set by gxp_settle_orientation */
            own->edge_plane[0] = own->edge_plane[1] = own->edge_plane[2] = GXB_NONE;
            return 1;
        }
    }
    return 0;
}

/* Does the triangle turn counter-clockwise about the plane's normal? Decided in projection along the plane's axis. */
static void gxp_settle_orientation(const gx_body *body, const gxp_surface *s, gxb_triangle *t, uint32_t index) {
    const gxb_cplane *plane = gxb_complex_plane(body->complex, t->plane);
    const int i = (int)(plane->axis + 1) % 3, j = (int)(plane->axis + 2) % 3;
    double p[3][2];
    int k;
    for (k = 0; k < 3; k++) {
        const double *x = s->given->vertices + 3 * (size_t)s->given->triangles[3 * (size_t)index + (size_t)k];
        p[k][0] = x[i];
        p[k][1] = x[j];
    }
    t->orientation = gxb_orient2d(p[0], p[1], p[2]) * plane->axis_sign;
}

/* Gives the triangle its points and its plane in the complex. */
static gx_result gxp_prepare_triangle(gxp_cut *cut, gxp_surface *s, uint32_t index) {
    gx_body *body = cut->body;
    gxb_triangle *t = &s->triangles[index];
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t v = s->merged[s->given->triangles[3 * index + k]];
        if (s->point[v] == GXP_NONE) {
            const gx_result result =
                gxb_complex_add_point(body->complex, s->given->vertices + 3 * (size_t)v, &s->point[v]);
            if (result != GX_OK) return result;
        }
        t->point[k] = s->point[v];
    }
    t->label = s->label + index;
    t->wall = s->given->kind == GX_SURFACE_SHEET;
    if (gxp_borrow_plane(body, s, index)) {
        gxp_settle_orientation(body, s, t, index);
        return GX_OK;
    }
    return gxb_complex_add_plane(body->complex, t);
}

/* Inserts the triangle into every element that it meets. */
static gx_result gxp_insert_triangle(gxp_cut *cut, gxp_surface *s, uint32_t index, int scoped) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const double *p[3];
    uint32_t k, i;
    gx_result result;
    for (k = 0; k < 3; k++) p[k] = s->given->vertices + 3 * (size_t)s->given->triangles[3 * index + k];
    result = gxp_find_elements(body, p, &scratch->near_elements);
    if (result == GX_OK && scratch->near_elements.count > 0) result = gxp_prepare_triangle(cut, s, index);
    for (i = 0; i < scratch->near_elements.count && result == GX_OK; i++) {
        const uint32_t element = scratch->near_elements.data[i];
        result = gxb_complex_insert(body->complex, &s->triangles[index], element, scoped ? gxp_in_scope : NULL, body);
        if (result == GX_OK && s->triangles[index].wall)
            result = gxp_cover_pinches(body, &s->triangles[index], element, scoped);
    }
    return result;
}

/* The place of a coordinate on a grid of 512 intervals: bits of x 2^(shift + 9), rounded down. In the frame the body is
   at most 1 long; further out the grid repeats. No arithmetic of doubles, so that it is the same under every flag. */
static uint32_t gxp_grid_place(double x, int shift) {
    uint64_t bits, m;
    int power;
    memcpy(&bits, &x, sizeof bits);
    power = (int)(bits >> 52 & 0x7ff) - 1075 + shift + 9;
    m = (bits & 0xfffffffffffffu) | 0x10000000000000u;
    m = power > 8 || power < -52 ? 0 : power >= 0 ? m << power : m >> -power;
    return (uint32_t)(bits >> 63 ? ~m : m) & 511;
}

/* The place of a point on a Z-curve through the body: the bits of its three grid places in turn */
static uint32_t gxp_curve_place(const gx_body *body, const double x[3]) {
    uint32_t place = 0, k;
    for (k = 0; k < 3; k++) {
        uint32_t bits = gxp_grid_place(x[k], gxb_complex_shift(body->complex)); /* two zeros go between its bits */
        bits = (bits | bits << 16) & 0x030000ffu;
        bits = (bits | bits << 8) & 0x0300f00fu;
        bits = (bits | bits << 4) & 0x030c30c3u;
        bits = (bits | bits << 2) & 0x09249249u;
        place |= bits << k;
    }
    return place;
}

#define GXP_LAST_ROUND 31u
/* Room is made for at most this many times the items that the rounds before the last one have made. */
#define GXP_EXPECTED 7u

/* Inserts the triangles in rounds, each eight times as large as the one before: planes in random order make shallow
   trees. Within a round the triangles follow a curve, so that the data of an element is in the cache for all its
   triangles [Amenta, Choi, Rote, Incremental constructions con BRIO (2003)]. The order is always the same. The last
   round has most triangles; the rounds before it tell how much room it needs. */
static gx_result gxp_insert_surface(gxp_cut *cut, gxp_surface *s, int scoped) {
    const uint32_t count = (uint32_t)s->given->triangle_count;
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    uint32_t i, before = 0;
    gx_result result;
    scratch->order.count = 0;
    result = gxp_keys_room(body, &scratch->order, 2 * (size_t)count); /* sorting takes as much again */
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint64_t random = gxp_mix(scratch->order.count); /* triangles without area change no other's round */
        uint32_t round = GXP_LAST_ROUND, place;
        if (s->flat[i]) continue;
        while (round > 16 && !(random >> 3 * (GXP_LAST_ROUND - round) & 7)) round--;
        before += round < GXP_LAST_ROUND;
        place = gxp_curve_place(body, s->given->vertices + 3 * (size_t)s->given->triangles[3 * (size_t)i]);
        result = gxp_push_key(body, &scratch->order, round << 27 | place, i);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, &scratch->order, 0, scratch->order.count);
    for (i = 0; i < scratch->order.count && result == GX_OK; i++) {
        if (i == before && before >= 4) {
            const uint32_t times = (scratch->order.count - before) / before;
            gxb_complex_reserve(body->complex, times < GXP_EXPECTED ? times : GXP_EXPECTED);
        }
        result = gxp_insert_triangle(cut, s, GXP_SECOND(scratch->order.data[i]), scoped);
    }
    return result;
}

/* >>solids: winding numbers of leaves ------------------------------------------------------------------------------ */
/* In: a closed surface that is in the complex. Out: the leaves around which it winds, which are to be removed. Touches
   marks of leaves only. */

/* The solid's winding number behind the facet minus that in front of it: triangles that face the facet's front count 1.
   Sets labelled to 1 if the solid covers the facet, else to 0. */
static int32_t gxp_winding_step(const gx_body *body, const gxp_surface *s, uint32_t facet, int *labelled) {
    const gxb_complex *cx = body->complex;
    int32_t step = 0;
    uint32_t l;
    *labelled = 0;
    for (l = gxb_complex_facet(cx, facet)->labels; l != GXB_NONE; l = gxb_complex_label(cx, l)->next) {
        if (gxb_complex_label(cx, l)->triangle < s->label ||
            gxb_complex_label(cx, l)->triangle - s->label >= s->given->triangle_count)
            continue;
        *labelled = 1;
        step += gxb_complex_label(cx, l)->orientation;
    }
    return step;
}

/* The winding number around a node. Returns 0 if the node is on the surface and has none. */
static int gxp_node_winding(const gx_body *body, const gxp_surface *s, uint32_t node, int32_t *winding) {
    const double *x = body->mesh.positions + 3 * (size_t)node;
    int on_surface, k;
    *winding = 0;
    for (k = 0; k < 3; k++)
        if (x[k] < s->low[k] || x[k] > s->high[k]) return 1;
    *winding = gxb_winding_number(s->given->vertices, s->given->triangles, s->given->triangle_count, x, &on_surface);
    return !on_surface;
}

/* The winding number around a leaf: around one of its nodes off the surface, else around a point inside it. */
static gx_result gxp_leaf_winding(gx_body *body, const gxp_surface *s, uint32_t leaf, int32_t *winding) {
    gxp_scratch *scratch = &body->scratch;
    const gx_surface *g = s->given;
    const gxb_leaf *l = gxb_complex_leaf(body->complex, leaf);
    uint32_t i;
    gx_result result;
    for (i = 0; i < 4 && l->facet_count == 0; i++)
        if (gxp_node_winding(body, s, gxb_complex_element_nodes(body->complex, l->element)[i], winding)) return GX_OK;
    result = gxp_collect_leaf_points(body, leaf);
    for (i = 0; i < scratch->leaf_points.count && result == GX_OK; i++)
        if (scratch->leaf_points.data[i] < body->mesh.node_count &&
            gxp_node_winding(body, s, scratch->leaf_points.data[i], winding))
            return GX_OK;
    if (result == GX_OK)
        *winding = gxb_complex_winding(body->complex, scratch->leaf_points.data, scratch->leaf_points.count,
                                       g->vertices, g->triangles, g->triangle_count);
    return result;
}

/* Is the leaf kept and, if the cut has a scope, in it? The solid did not divide other leaves, so that they have no
   single winding number to pass on. */
static int gxp_has_winding(gx_body *body, uint32_t leaf, int scoped) {
    return gxp_is_kept(body, leaf) && (!scoped || gxp_in_scope(body, leaf));
}

/* Notes the winding number of a leaf and lists it, unless this flood has met it. */
static gx_result gxp_visit_winding(gx_body *body, uint32_t leaf, int32_t winding) {
    if (body->leaves.mark[leaf].stamp == body->scratch.stamp) return GX_OK;
    body->leaves.mark[leaf].stamp = body->scratch.stamp;
    body->leaves.mark[leaf].winding = winding;
    return gxp_push(body, &body->scratch.flooded, leaf);
}

/* Passes the winding number 0 on from an element that no triangle has touched to its neighbours of that kind. */
static gx_result gxp_spread_untouched(gx_body *body, uint32_t element, int scoped) {
    uint32_t k;
    gx_result result = GX_OK;
    for (k = 0; k < 4 && result == GX_OK; k++) {
        const uint32_t other = gxp_neighbour(body, element, k); /* the first leaf of that element too */
        if (other != GXB_NONE && gxb_complex_leaf(body->complex, other)->facet_count == 0 &&
            gxp_has_winding(body, other, scoped))
            result = gxp_visit_winding(body, other, 0);
    }
    return result;
}

/* Passes the winding number on to the neighbours of a leaf: to all of a leaf inside the solid, from a leaf outside only
   across the solid's surface and, where the seeds are many cells, to those that need no more facets for that. */
static gx_result gxp_spread_winding(gx_body *body, const gxp_surface *s, uint32_t leaf, int scoped) {
    gxb_complex *cx = body->complex;
    const int32_t winding = body->leaves.mark[leaf].winding;
    const int many = s->given->scope_slots != NULL;
    uint32_t first, count = 0, i;
    gx_result result = GX_OK;
    if (many && winding == 0 && gxb_complex_leaf(cx, leaf)->facet_count == 0)
        return gxp_spread_untouched(body, leaf, scoped);
    if (winding != 0) result = gxb_complex_open_element(cx, gxb_complex_leaf(cx, leaf)->element);
    if (result == GX_OK) result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const gxb_facet *f = gxb_complex_facet(cx, gxp_item(cx, first + i));
        const int front = f->leaf[0] == leaf;
        int labelled;
        const int32_t step = gxp_winding_step(body, s, gxp_item(cx, first + i), &labelled);
        if ((winding != 0 || labelled || (many && f->face == GXB_NONE)) &&
            gxp_has_winding(body, f->leaf[front], scoped))
            result = gxp_visit_winding(body, f->leaf[front], winding + (front ? step : -step));
    }
    return result;
}

/* Spreads from the listed leaves on, from *done to the end of the list, which grows. */
static gx_result gxp_flood_winding(gx_body *body, const gxp_surface *s, uint32_t *done, int scoped) {
    gx_result result = GX_OK;
    while (*done < body->scratch.flooded.count && result == GX_OK)
        result = gxp_spread_winding(body, s, body->scratch.flooded.data[(*done)++], scoped);
    return result;
}

/* Does the flood reach this cell from others of its fragment? It crosses faces and stays in the scope. The answer is
   uncertain, 0, if elements meet in nodes or edges only, or if the caller lists the cells of a scope. */
static int gxp_is_flooded(const gxp_cut *cut, uint32_t cell) {
    const uint32_t *node = gxb_complex_element_nodes(cut->body->complex, cut->body->cells.data[cell].element);
    uint32_t k;
    if (cut->desc->scope_cell_count > 0) return 0;
    for (k = 0; k < 4; k++)
        if (cut->body->mesh.node_pinched[node[k]]) return 0;
    return 1;
}

/* A fragment that the surface does not touch may lie inside the solid as a whole. Adds one leaf of each such fragment
   to the seeds, and one of each cell that the flood may miss. The fragments are those of before the cut. */
static gx_result gxp_seed_untouched(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_view *view = &body->view;
    gxp_scratch *scratch = &body->scratch;
    gx_result result = gxp_update_view(body);
    uint32_t i;
    scratch->seeded.count = 0;
    if (result == GX_OK) result = gxp_words_room(body, &scratch->seeded, view->fragment_count);
    if (result != GX_OK) return result;
    if (view->fragment_count > 0) memset(scratch->seeded.data, 0, view->fragment_count * sizeof *scratch->seeded.data);
    for (i = 0; i < scratch->seed_leaves.count; i++)
        if (gxp_is_kept(body, scratch->seed_leaves.data[i]))
            scratch->seeded.data[gxp_cell_fragment(body, body->leaves.data[scratch->seed_leaves.data[i]].cell)] = 1;
    for (i = 0; i < view->count && result == GX_OK; i++) {
        const uint32_t cell = view->cell[i];
        if (scratch->seeded.data[view->fragment[i]] && gxp_is_flooded(cut, cell)) continue;
        scratch->seeded.data[view->fragment[i]] = 1;
        result = gxp_push(body, &scratch->seed_leaves, body->cells.data[cell].first_leaf);
    }
    return result;
}

/* Adds one leaf of each cell in the surface's own scope to the seeds. The flood crosses all facets inside a cell. */
static gx_result gxp_seed_slots(gx_body *body, const gx_surface *s) {
    gx_result result = GX_OK;
    size_t i;
    for (i = 0; i < s->scope_slot_count && result == GX_OK; i++) {
        const uint32_t cell = gxp_kept_cell(body, s->scope_slots[i]);
        if (cell != GXP_NONE) result = gxp_push(body, &body->scratch.seed_leaves, body->cells.data[cell].first_leaf);
    }
    return result;
}

/* Finds the winding numbers of the seeds and of all leaves that they lead to: scratch.flooded. */
static gx_result gxp_find_windings(gx_body *body, const gxp_surface *s, int scoped) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i, done = 0;
    gx_result result = gxp_start_words(body, &scratch->flooded, scratch->seed_leaves.count);
    scratch->stamp++;
    for (i = 0; i < scratch->seed_leaves.count && result == GX_OK; i++) {
        const uint32_t leaf = scratch->seed_leaves.data[i];
        int32_t winding = 0;
        if (!gxp_has_winding(body, leaf, scoped) || body->leaves.mark[leaf].stamp == scratch->stamp) continue;
        result = gxp_leaf_winding(body, s, leaf, &winding);
        if (result == GX_OK) result = gxp_visit_winding(body, leaf, winding);
        if (result == GX_OK) result = gxp_flood_winding(body, s, &done, scoped);
    }
    return result;
}

/* Does the solid wind around the leaf? Its flood, the last one, has met all such leaves. */
static int gxp_is_wound(const gx_body *body, uint32_t leaf) {
    return body->leaves.mark[leaf].stamp == body->scratch.stamp && body->leaves.mark[leaf].winding != 0;
}

/* Appends a leaf that goes to scratch.removed. Its element gets facets: what lies behind these is touched. */
static gx_result gxp_push_outside(gx_body *body, uint32_t leaf) {
    const gx_result result = gxb_complex_open_element(body->complex, gxb_complex_leaf(body->complex, leaf)->element);
    return result == GX_OK ? gxp_push(body, &body->scratch.removed, leaf) : result;
}

/* Appends to scratch.removed the leaves around which a solid that keeps does not wind. */
static gx_result gxp_find_outside(gx_body *body, int scoped) {
    gx_result result = GX_OK;
    uint32_t leaf;
    for (leaf = 0; leaf < body->leaves.count && result == GX_OK; leaf++)
        if (gxp_has_winding(body, leaf, scoped) && !gxp_is_wound(body, leaf)) result = gxp_push_outside(body, leaf);
    return result;
}

/* Notes that the surface gives its material to the leaves around which it winds. */
static gx_result gxp_note_given(gx_body *body, const gxp_surface *s) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = gxp_keys_room(body, &scratch->given_to, scratch->flooded.count);
    for (i = 0; i < scratch->flooded.count && result == GX_OK; i++)
        if (gxp_is_wound(body, scratch->flooded.data[i]))
            result = gxp_push_key(body, &scratch->given_to, scratch->flooded.data[i], (uint32_t)s->number);
    return result;
}

/* Finds the leaves around which a closed surface winds. Appends to scratch.removed those that a solid removes: these
   or, if it keeps these, the others; or notes their material. All surfaces of the cut are in the complex. */
static gx_result gxp_find_solid(gxp_cut *cut, const gxp_surface *s) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    int scoped;
    gx_result result = gxp_stamp_surface(cut, s->given, &scoped);
    if (result == GX_OK) result = gxp_list_marked_leaves(body, 0, &scratch->seed_leaves);
    if (result == GX_OK)
        result = s->given->scope_slots != NULL ? gxp_seed_slots(body, s->given) : gxp_seed_untouched(cut);
    if (result == GX_OK) result = gxp_find_windings(body, s, scoped);
    if (result == GX_OK && s->given->kind == GX_SURFACE_KEEP) return gxp_find_outside(body, scoped);
    if (result == GX_OK && s->given->kind == GX_SURFACE_MATERIAL) return gxp_note_given(body, s);
    if (result == GX_OK) result = gxp_words_room(body, &scratch->removed, scratch->flooded.count);
    for (i = 0; i < scratch->flooded.count && result == GX_OK; i++)
        if (gxp_is_wound(body, scratch->flooded.data[i]))
            result = gxp_push(body, &scratch->removed, scratch->flooded.data[i]);
    return result;
}

/* Appends the leaves on both sides of the undivided facets that make up a facet and that the surface covers. */
static gx_result gxp_push_covered(gx_body *body, const gxp_surface *s, uint32_t facet, gxp_words *leaves) {
    const uint32_t child = gxb_complex_facet(body->complex, facet)->child;
    gx_result result;
    int covered;
    if (child != GXB_NONE) {
        result = gxp_push_covered(body, s, child, leaves);
        return result == GX_OK ? gxp_push_covered(body, s, child + 1, leaves) : result;
    }
    (void)gxp_winding_step(body, s, facet, &covered);
    return covered ? gxp_push_leaves_beside(body, facet, leaves) : GX_OK;
}

/* Lists the leaves beside one of the cut's surfaces. */
static gx_result gxp_list_covered(gx_body *body, const gxp_surface *s, gxp_words *leaves) {
    const uint32_t count = gxb_complex_marked_count(body->complex);
    uint32_t i;
    gx_result result = GX_OK;
    leaves->count = 0;
    for (i = 0; i < count && result == GX_OK; i++)
        result = gxp_push_covered(body, s, gxb_complex_marked_facet(body->complex, i), leaves);
    return result;
}

/* Appends to scratch.removed the leaves that lie in none of a shape's surfaces. Notes the materials of the others. */
static gx_result gxp_find_shape(gxp_cut *cut, const gxp_surface *surfaces) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    gx_result result = gxp_start_words(body, &scratch->wound, body->leaves.count);
    uint32_t i, leaf;
    size_t s;
    for (s = 0; s < cut->desc->surface_count && result == GX_OK; s++) {
        result = gxp_list_covered(body, &surfaces[s], &scratch->seed_leaves);
        if (result == GX_OK) result = gxp_seed_untouched(cut);
        if (result == GX_OK) result = gxp_find_windings(body, &surfaces[s], 0);
        for (i = 0; i < scratch->flooded.count && result == GX_OK; i++)
            if (gxp_is_wound(body, scratch->flooded.data[i]))
                result = gxp_push(body, &scratch->wound, scratch->flooded.data[i]);
        if (gxp_is_mixed(body) && result == GX_OK) result = gxp_note_given(body, &surfaces[s]);
    }
    gxp_sort_unique(&scratch->wound);
    for (leaf = i = 0; leaf < body->leaves.count && result == GX_OK; leaf++)
        if (i < scratch->wound.count && scratch->wound.data[i] == leaf)
            i++;
        else
            result = gxp_push_outside(body, leaf);
    return result;
}

/* >>materials: what is of which material --------------------------------------------------------------------------- */
/* Each cell is of one material. Two leaves of an element that an open facet joins, but that are in different cells, are
   at an interface: it divides cells, and joins their copies as a link does. In: the leaves that a cut's surfaces give
   materials; pairs of materials to be released. Out: cells that are to be divided by material, those of whole elements
   with their new one; walls at interfaces. Touches cells, through the undo log, walls and scratch. */

/* The material that the cut gives to a leaf; GXP_NONE: that of its cell stays. */
static uint32_t gxp_given_material(const gx_body *body, uint32_t leaf) {
    const gxp_keys *given = &body->scratch.given_to;
    const uint32_t i = given->count > 0 ? gxp_first_key(given, (uint64_t)leaf << 32) : 0;
    return i < given->count && GXP_FIRST(given->data[i]) == leaf ? GXP_SECOND(given->data[i]) : GXP_NONE;
}

/* The material of a leaf once the cut is made */
static uint32_t gxp_leaf_material(const gx_body *body, uint32_t leaf) {
    const uint32_t given = gxp_given_material(body, leaf);
    return given != GXP_NONE ? given : body->cells.data[body->leaves.data[leaf].cell].material;
}

/* Is the open facet between two leaves of an element an interface? While cells are divided, leaves of one cell are of
   two materials if the cut gives them such. */
static int gxp_is_interface(const gx_body *body, uint32_t leaf, uint32_t other) {
    return gxp_is_mixed(body) && (body->leaves.data[leaf].cell != body->leaves.data[other].cell ||
                                  gxp_given_material(body, leaf) != gxp_given_material(body, other));
}

/* Has the element kept cells of several materials? */
static int gxp_has_materials(const gx_body *body, uint32_t element) {
    uint32_t cell = element, first = GXP_NONE;
    for (; cell != GXP_NONE; cell = body->cells.data[cell].next) {
        if (!body->cells.data[cell].kept) continue;
        if (first != GXP_NONE && first != body->cells.data[cell].material) return 1;
        first = body->cells.data[cell].material;
    }
    return 0;
}

/* Gives a material to the cell of a whole element. */
static gx_result gxp_remake_cell(gx_body *body, uint32_t cell, uint32_t material) {
    gxp_cell *c = &body->cells.data[cell];
    const gx_result result = gxp_save_cell(body, cell);
    if (result != GX_OK) return result;
    c->material = material & INT32_MAX;
    gxi_tet_mass(c->volume, gxp_density(body, c), c->mass);
    return gxp_push(body, &body->scratch.remade, cell);
}

/* Gives the leaves that are left their materials. Of several surfaces around a leaf the last one counts. Whole elements
   have theirs at once; cells that may have to be divided are touched. */
static gx_result gxp_give_materials(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_keys *given = &body->scratch.given_to;
    uint32_t i, n = 0;
    gx_result result = gxp_sort_keys(body, given, 0, given->count);
    for (i = 0; i < given->count && result == GX_OK; i++) {
        const uint32_t leaf = GXP_FIRST(given->data[i]), cell = body->leaves.data[leaf].cell;
        const uint32_t surface = GXP_SECOND(given->data[i]), material = cut->desc->surfaces[surface].material;
        const uint32_t element = body->cells.data[cell].element;
        if (i + 1 < given->count && GXP_FIRST(given->data[i + 1]) == leaf) continue;
        if (!gxp_is_kept(body, leaf) || body->cells.data[cell].material == material) continue;
        if (!gxp_is_mass(gxp_element_volume(body, element) * body->mesh.materials[material].density)) {
            cut->failure.surface = surface;
            return gxp_fail(&cut->failure, GX_ERROR_RANGE, "surfaces.material", SIZE_MAX);
        }
        if (gxb_complex_root(body->complex, element) == 2 * leaf)
            result = gxp_remake_cell(body, cell, material);
        else {
            given->data[n++] = (uint64_t)leaf << 32 | material;
            result = gxp_push(body, &body->scratch.touched, cell);
        }
    }
    given->count = n;
    return result;
}

/* Does the cut release what is of material a from what is of material b? */
static int gxp_is_released(const gx_cut_desc *desc, uint32_t a, uint32_t b) {
    size_t i;
    int k, released = 0;
    for (i = 0; i < desc->release_count && a != b; i++)
        for (k = 0; k < 2; k++) {
            const uint32_t p = desc->release[2 * i + (size_t)k], q = desc->release[2 * i + 1 - (size_t)k];
            released |= (p == GX_ANY_MATERIAL || p == a) && (q == GX_ANY_MATERIAL || q == b);
        }
    return released;
}

/* May something behind a face of the element be released from its material? */
static int gxp_may_release(const gxp_cut *cut, uint32_t element, uint32_t material) {
    const gx_body *body = cut->body;
    uint32_t k, cell;
    if (body->scratch.given_to.count > 0) return 1;
    for (k = 0; k < 4; k++)
        for (cell = gxp_neighbour(body, element, k); cell != GXP_NONE; cell = body->cells.data[cell].next)
            if (body->cells.data[cell].kept && gxp_is_released(cut->desc, material, body->cells.data[cell].material))
                return 1;
    return 0;
}

/* Makes walls of the open facets of a leaf at which the cut releases it from what lies behind. */
static gx_result gxp_release_leaf(gxp_cut *cut, uint32_t leaf, int scoped) {
    gx_body *body = cut->body;
    gxb_complex *cx = body->complex;
    const uint32_t material = gxp_leaf_material(body, leaf), element = gxb_complex_leaf(cx, leaf)->element;
    uint32_t first, count = 0, i;
    gx_result result;
    if (gxb_complex_leaf(cx, leaf)->facet_count == 0 && !gxp_may_release(cut, element, material)) return GX_OK;
    result = gxb_complex_open_element(cx, element);
    if (result == GX_OK) result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = gxp_item(cx, first + i);
        const gxb_facet *f = gxb_complex_facet(cx, facet);
        const uint32_t other = f->leaf[f->leaf[0] == leaf];
        if (gxp_is_link(body, facet) && gxp_is_released(cut->desc, material, gxp_leaf_material(body, other)) &&
            (!scoped || gxp_in_scope(body, other)))
            result = gxb_complex_set_wall(cx, facet);
    }
    return result;
}

/* Makes walls of all that the cut releases. */
static gx_result gxp_release_materials(gxp_cut *cut) {
    gx_body *body = cut->body;
    const int scoped = gxp_has_scope(cut->desc);
    uint32_t leaf;
    gx_result result = gxp_stamp_scope(cut);
    for (leaf = 0; leaf < body->leaves.count && result == GX_OK; leaf++)
        if (gxp_is_kept(body, leaf) && (!scoped || gxp_in_scope(body, leaf)))
            result = gxp_release_leaf(cut, leaf, scoped);
    return result;
}

/* >>links: shares of element faces that no wall covers ------------------------------------------------------------- */
/* In: the links of new cells. Out: the smallest share of a face, and walls in the complex where a share is too small.
   Shares are bounded in doubles first and computed from exact coordinates where that does not decide. */

/* r += a b */
static void gxp_num_add_product(gxb_num *r, const gxb_num *a, const gxb_num *b) {
    GXB_NUM(p);
    GXB_NUM(s);
    gxb_num_mul(&p, a, b);
    gxb_num_add(&s, r, &p);
    r->sign = s.sign;
    r->exp = s.exp;
    r->n = s.n;
    memcpy(r->d, s.d, s.n * sizeof *s.d);
}

typedef struct gxp_fine_point {
    gxb_num c[4];
    gxb_limb limbs[4][32];
} gxp_fine_point;

/* Twice the area of a facet, projected along the axis of its plane, from approximate positions; *error bounds its
   error. */
static gx_result gxp_rough_area(gxb_complex *cx, uint32_t facet, double *area, double *error) {
    const uint32_t axis = gxb_complex_plane(cx, gxb_complex_facet(cx, facet)->plane)->axis, x = (axis + 1) % 3,
                   y = (axis + 2) % 3;
    const gxb_ball *o = NULL;
    double a[2] = {0, 0}, b[2] = {0, 0}, sum = 0;
    uint32_t e0, en, i;
    const gx_result result = gxb_facet_resolve_edges(cx, facet, &e0, &en);
    *error = 0;
    for (i = 0; i < en && result == GX_OK; i++) {
        const gxb_ball *p = &gxb_complex_point(cx, gxb_complex_edge_start(cx, gxp_item(cx, e0 + i)))->ball;
        double size;
        if (i == 0) o = p;
        a[0] = b[0];
        a[1] = b[1];
        b[0] = p->x[x] - o->x[x];
        b[1] = p->x[y] - o->x[y];
        size = fabs(a[0]) + fabs(a[1]) + fabs(b[0]) + fabs(b[1]);
        sum += a[0] * b[1] - a[1] * b[0];
        *error += size * (size * 1e-15 + 4 * (p->error + o->error));
    }
    *area = fabs(sum);
    return result;
}

/* sum += (b - o) x (a - o) in the plane of two barycentric coordinates */
static GXP_APART void gxp_fine_cross(gxb_num *sum, const gxp_fine_point *a, const gxp_fine_point *b,
                                     const gxp_fine_point *o, const unsigned *axes) {
    GXB_NUM(x);
    GXB_NUM(y);
    GXB_NUM(z);
    GXB_NUM(w);
    gxb_num_sub(&x, &b->c[axes[1]], &o->c[axes[1]]);
    gxb_num_sub(&y, &b->c[axes[2]], &o->c[axes[2]]);
    gxb_num_sub(&z, &a->c[axes[1]], &o->c[axes[1]]);
    gxb_num_sub(&w, &a->c[axes[2]], &o->c[axes[2]]);
    z.sign = -z.sign;
    gxp_num_add_product(sum, &x, &w);
    gxp_num_add_product(sum, &y, &z);
}

/* The polygon of scratch.facet_points as a share of the face opposite to node k, in numbers of any size: its area in
   the plane of two barycentric coordinates, where the face has area 1. */
static double gxp_fine_share(gx_body *body, uint32_t element, uint32_t k) {
    gxp_fine_point p[3];
    unsigned axes[3];
    uint32_t i;
    int c;
    GXB_NUM(sum);
    gxi_part_axes(k, axes);
    for (i = 0; i < 3; i++)
        for (c = 0; c < 4; c++) p[i].c[c].d = p[i].limbs[c];
    for (i = 0; i < body->scratch.facet_points.count; i++) {
        /* a: this point, b: the one before */
        gxp_fine_point *const a = &p[1 + i % 2], *const b = &p[1 + (i + 1) % 2];
        gxb_complex_barycentric_fine(body->complex, body->scratch.facet_points.data[i], element,
                                     i == 0 ? p[0].c : a->c);
        if (i >= 2) gxp_fine_cross(&sum, a, b, &p[0], axes);
    }
    return fabs(gxb_num_to_double(&sum));
}

/* Replaces the leaf behind each interface of new cells by its cell. Each stands there once. */
static gx_result gxp_settle_interfaces(gx_body *body) {
    gxp_keys *keys = &body->scratch.interfaces;
    uint32_t i, n = 0;
    gx_result result;
    for (i = 0; i < keys->count; i++)
        keys->data[i] = (keys->data[i] & ~(uint64_t)UINT32_MAX) | body->leaves.data[GXP_SECOND(keys->data[i])].cell;
    result = gxp_sort_keys(body, keys, 0, keys->count);
    for (i = 0; i < keys->count && result == GX_OK; i++)
        if (n == 0 || keys->data[n - 1] != keys->data[i]) keys->data[n++] = keys->data[i];
    keys->count = n;
    return result;
}

/* Replaces the leaf behind each link of new cells by its cell, and sorts the links of each cell: those to one cell
   stand together. */
static gx_result gxp_settle_links(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i, j;
    gx_result result = gxp_push(body, &scratch->link_first, scratch->links.count);
    for (i = 0; i < scratch->new_cells.count && result == GX_OK; i++) {
        const uint32_t from = scratch->link_first.data[i], to = scratch->link_first.data[i + 1];
        uint64_t *link = scratch->links.data;
        body->cells.new_index[scratch->new_cells.data[i]] = i;
        for (j = from; j < to; j++)
            link[j] = (uint64_t)body->leaves.data[GXP_LINK_CELL(link[j])].cell << 33 | (link[j] & 0x1ffffffffu);
        result = gxp_sort_keys(body, &scratch->links, from, to);
    }
    return result == GX_OK ? gxp_settle_interfaces(body) : result;
}

/* The index of a cell among the new ones, or GXP_NONE */
static uint32_t gxp_new_index(const gx_body *body, uint32_t cell) {
    const uint32_t i = body->cells.new_index[cell];
    return i < body->scratch.new_cells.count && body->scratch.new_cells.data[i] == cell ? i : GXP_NONE;
}

/* The rough share of the link first ... end-1 in its face, and a bound for the error. It stops once the share is
   certainly more than enough. */
static gx_result gxp_rough_share(gx_body *body, uint32_t first, uint32_t end, double enough, double *share,
                                 double *error) {
    gxb_complex *cx = body->complex;
    const gxb_cplane *plane =
        gxb_complex_plane(cx, gxb_complex_facet(cx, GXP_LINK_FACET(body->scratch.links.data[first]))->plane);
    const double whole = fabs(plane->filter.n[plane->axis]); /* the normal is the product of two edges of the face */
    double part, part_error;
    gx_result result = GX_OK;
    *share = *error = 0;
    for (; first < end && !(*share - 4 * *error > enough * whole) && result == GX_OK; first++) {
        result = gxp_rough_area(cx, GXP_LINK_FACET(body->scratch.links.data[first]), &part, &part_error);
        *share += part;
        *error += part_error + plane->filter.error;
    }
    /* nothing is known */
    if (!(*error < 0.5 * whole) || !(*share < 8 * whole)) {
        *share = 0;
        *error = 1;
        return result;
    }
    *share /= whole;
    *error = 4 * *error / whole;
    return result;
}

/* Is the link first ... end-1 certainly too large to be severed or to be the smallest? *bound: the smallest share is at
   most this; it is lowered. */
static gx_result gxp_is_wide(gxp_cut *cut, uint32_t first, uint32_t end, double *bound, int *wide) {
    const double enough = fmax(*bound, cut->desc->sever_below);
    double share, error;
    const gx_result result = gxp_rough_share(cut->body, first, end, enough, &share, &error);
    *wide = share - error > enough;
    if (share + error < *bound) *bound = share + error;
    return result;
}

/* The share of the link first ... end-1 in its face, from exact coordinates */
static gx_result gxp_weigh_link(gx_body *body, uint32_t first, uint32_t end, double *share) {
    uint32_t k;
    const uint32_t element = gxp_face_element(
        body->complex, gxb_complex_facet(body->complex, GXP_LINK_FACET(body->scratch.links.data[first]))->face, &k);
    gx_result result = gxb_complex_open_element(body->complex, element);
    *share = 0;
    for (; first < end && result == GX_OK; first++) {
        result = gxp_collect_facet_points(body, GXP_LINK_FACET(body->scratch.links.data[first]));
        if (result == GX_OK) *share += gxp_fine_share(body, element, k);
    }
    return result;
}

/* Weighs the link first ... end-1 and severs it if its share is below the ratio. */
static gx_result gxp_judge_link(gxp_cut *cut, uint32_t first, uint32_t end) {
    gx_body *body = cut->body;
    double share;
    gx_result result = gxp_weigh_link(body, first, end, &share);
    if (result != GX_OK) return result;
    if (share < cut->report.min_link_ratio) cut->report.min_link_ratio = share;
    if (share >= cut->desc->sever_below) return GX_OK;
    cut->report.severed_links++;
    for (; first < end && result == GX_OK; first++)
        result = gxb_complex_set_wall(body->complex, GXP_LINK_FACET(body->scratch.links.data[first]));
    return result;
}

/* Is a link not weighed? Where an element has several materials, cells of all of them lie side by side at a face, and
   each has its share of what joins the two elements. */
static int gxp_is_shared_face(const gx_body *body, uint32_t cell, uint32_t other) {
    return gxp_is_mixed(body) && (gxp_has_materials(body, body->cells.data[cell].element) ||
                                  gxp_has_materials(body, body->cells.data[other].element));
}

/* Weighs the links of a new cell roughly. All facets of a face between the same two cells are one link. Whole faces are
   skipped, and links to new cells before this one. Links that may be the smallest or may have to be severed are noted
   in scratch.narrow. *bound: the smallest share so far. */
static gx_result gxp_weigh_links(gxp_cut *cut, uint32_t index, double *bound) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const uint32_t last = scratch->link_first.data[index + 1];
    uint32_t first, end;
    int wide = 1;
    gx_result result = GX_OK;
    for (first = scratch->link_first.data[index]; first < last && result == GX_OK; first = end) {
        const uint32_t other = GXP_LINK_CELL(scratch->links.data[first]),
                       facet = GXP_LINK_FACET(scratch->links.data[first]);
        for (end = first + 1; end < last && GXP_LINK_CELL(scratch->links.data[end]) == other; end++) {}
        if (gxp_new_index(body, other) < index ||
            gxb_complex_face_facet(body->complex, gxb_complex_facet(body->complex, facet)->face) == facet ||
            gxp_is_shared_face(body, scratch->new_cells.data[index], other))
            continue;
        result = gxp_is_wide(cut, first, end, bound, &wide);
        if (result == GX_OK && !wide) result = gxp_push(body, &scratch->narrow, first);
        if (result == GX_OK && !wide) result = gxp_push(body, &scratch->narrow, end);
    }
    return result;
}

/* Weighs the noted links exactly that may still be the smallest or have to be severed. */
static gx_result gxp_judge_links(gxp_cut *cut, double bound) {
    const gxp_words *narrow = &cut->body->scratch.narrow;
    uint32_t i;
    int wide = 1;
    gx_result result = GX_OK;
    for (i = 0; i + 1 < narrow->count && result == GX_OK; i += 2) {
        result = gxp_is_wide(cut, narrow->data[i], narrow->data[i + 1], &bound, &wide);
        if (result == GX_OK && !wide) result = gxp_judge_link(cut, narrow->data[i], narrow->data[i + 1]);
    }
    return result;
}

/* Severs the links below the ratio. */
static gx_result gxp_sever_links(gxp_cut *cut) {
    double bound = 1;
    uint32_t i;
    gx_result result = GX_OK;
    cut->body->scratch.narrow.count = 0;
    for (i = 0; i < cut->body->scratch.new_cells.count && result == GX_OK; i++)
        result = gxp_weigh_links(cut, i, &bound);
    return result == GX_OK ? gxp_judge_links(cut, bound) : result;
}

/* >>cells: touched cells fall apart -------------------------------------------------------------------------------- */
/* In: walls that this cut made, leaves that it removed. Out: the touched cells divided into their connected parts, the
   new cells, and the links of these. Touches cells and leaves, through the undo log. */

/* Collects the cells on both sides of the walls that this cut made. */
static gx_result gxp_collect_touched(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = gxp_list_marked_leaves(body, 1, &scratch->wall_leaves);
    if (result == GX_OK) result = gxp_words_room(body, &scratch->touched, scratch->wall_leaves.count / 2);
    scratch->stamp++;
    for (i = 0; i < scratch->wall_leaves.count && result == GX_OK; i++) {
        const uint32_t cell = body->leaves.data[scratch->wall_leaves.data[i]].cell;
        if (gxb_complex_leaf(body->complex, scratch->wall_leaves.data[i])->removed ||
            body->cells.stamp[cell] == scratch->stamp)
            continue;
        body->cells.stamp[cell] = scratch->stamp;
        result = gxp_push(body, &scratch->touched, cell);
    }
    gxp_sort_unique(&scratch->touched);
    return result;
}

/* Adds each new leaf to the list of the cell from which it was split. */
static gx_result gxp_list_new_leaves(gxp_cut *cut) {
    gx_body *body = cut->body;
    uint32_t leaf;
    gx_result result = GX_OK;
    for (leaf = body->undo.counts[GXP_LEAVES]; leaf < body->leaves.count && result == GX_OK; leaf++) {
        const uint32_t parent = gxb_complex_leaf(body->complex, leaf)->parent, next = body->leaves.data[parent].next;
        body->leaves.data[leaf].next = next;
        result = gxp_set_leaf(body, parent, body->leaves.data[parent].cell, leaf);
    }
    return result;
}

/* Appends a cell to the element of another one, with that one's copies and without leaves. */
static gx_result gxp_new_cell(gx_body *body, uint32_t like, uint32_t *cell) {
    gx_result result = gxp_grow_rows(body, GXP_CELLS, 1);
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_SLOTS, 1);
    if (result == GX_OK) result = gxp_save_cell(body, like);
    if (result != GX_OK) return result;
    *cell = body->cells.count++;
    body->cells.data[*cell] = body->cells.data[like];
    body->cells.slot[*cell] = body->slots.count;
    body->slots.parent[body->slots.count++] = body->cells.slot[like];
    body->cells.data[like].next = *cell;
    body->cells.data[*cell].first_leaf = GXP_NONE;
    body->cells.stamp[*cell] = 0;
    body->cells.saved_by[*cell] = body->undo.cut_number;
    return GX_OK;
}

/* Lists in scratch.part_leaves the leaves that stay with one across walls. */
static gx_result gxp_follow_glue(gx_body *body, uint32_t leaf) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i = gxp_first_key(&scratch->glue, (uint64_t)leaf << 32);
    gx_result result = GX_OK;
    for (; i < scratch->glue.count && GXP_FIRST(scratch->glue.data[i]) == leaf && result == GX_OK; i++) {
        const uint32_t other = GXP_SECOND(scratch->glue.data[i]);
        if (body->leaves.mark[other].stamp == scratch->stamp ||
            body->leaves.data[other].cell != body->leaves.data[leaf].cell)
            continue;
        body->leaves.mark[other].stamp = scratch->stamp;
        result = gxp_push(body, &scratch->part_leaves, other);
    }
    return result;
}

/* Lists in scratch.part_leaves the leaves that open facets inside the element connect to the first one. Appends their
   links to scratch.links, for now with the leaf behind each. */
static gx_result gxp_walk_leaves(gx_body *body, uint32_t start) {
    gxp_scratch *scratch = &body->scratch;
    gxb_complex *cx = body->complex;
    uint32_t done = 0, first, count, i;
    gx_result result = gxb_complex_open_element(cx, gxb_complex_leaf(cx, start)->element);
    scratch->part_leaves.count = 0;
    body->leaves.mark[start].stamp = scratch->stamp;
    if (result == GX_OK) result = gxp_push(body, &scratch->part_leaves, start);
    if (result == GX_OK) result = gxp_push(body, &scratch->link_first, scratch->links.count);
    while (done < scratch->part_leaves.count && result == GX_OK) {
        const uint32_t leaf = scratch->part_leaves.data[done++];
        result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
        if (result == GX_OK) result = gxp_keys_room(body, &scratch->links, count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const uint32_t facet = gxp_item(cx, first + i);
            const gxb_facet *f = gxb_complex_facet(cx, facet);
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (!gxp_is_link(body, facet)) continue;
            if (f->face != GXB_NONE)
                scratch->links.data[scratch->links.count++] =
                    (uint64_t)other << 33 | (uint64_t)facet << 2 |
                    gxp_local_face(cx, gxb_complex_leaf(cx, leaf)->element, f->face);
            else if (gxp_is_interface(body, leaf, other))
                result = gxp_push_key(body, &scratch->interfaces, scratch->link_first.count - 1, other);
            else if (body->leaves.mark[other].stamp != scratch->stamp) {
                body->leaves.mark[other].stamp = scratch->stamp;
                result = gxp_push(body, &scratch->part_leaves, other);
            }
        }
        if (scratch->glue.count > 0 && result == GX_OK) result = gxp_follow_glue(body, leaf);
    }
    return result;
}

/* Gives scratch.part_leaves to a cell, as its list. */
static gx_result gxp_give_leaves(gx_body *body, uint32_t cell) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = gxp_save_cell(body, cell);
    for (i = scratch->part_leaves.count; i-- > 0 && result == GX_OK;)
        result = gxp_set_leaf(body, scratch->part_leaves.data[i], cell,
                              i + 1 < scratch->part_leaves.count ? scratch->part_leaves.data[i + 1] : GXP_NONE);
    if (result == GX_OK) body->cells.data[cell].first_leaf = scratch->part_leaves.data[0];
    return result;
}

/* Divides a touched cell into its connected parts, each of one material; the first one keeps the slot. */
static gx_result gxp_divide_cell(gxp_cut *cut, uint32_t cell) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const uint32_t material = body->cells.data[cell].material;
    uint32_t leaf, parts = 0, given, i;
    gx_result result = GX_OK;
    scratch->cell_leaves.count = 0;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next)
        result = gxp_push(body, &scratch->cell_leaves, leaf);
    scratch->stamp++;
    for (i = 0; i < scratch->cell_leaves.count && result == GX_OK; i++) {
        uint32_t slot = cell;
        leaf = scratch->cell_leaves.data[i];
        if (gxb_complex_leaf(body->complex, leaf)->removed || body->leaves.mark[leaf].stamp == scratch->stamp) continue;
        result = gxp_walk_leaves(body, leaf);
        if (result == GX_OK && parts++ > 0) {
            result = gxp_new_cell(body, cell, &slot);
            cut->report.created_cells++;
        }
        if (result == GX_OK) result = gxp_give_leaves(body, slot);
        given = gxp_given_material(body, leaf);
        if (result == GX_OK) body->cells.data[slot].material = (given == GXP_NONE ? material : given) & INT32_MAX;
        if (result == GX_OK) result = gxp_push(body, &scratch->new_cells, slot);
    }
    if (result == GX_OK && parts == 0) {
        result = gxp_save_cell(body, cell);
        if (result != GX_OK) return result;
        body->cells.data[cell].kept = 0;
        body->cells.data[cell].first_leaf = GXP_NONE;
        cut->report.removed_cells++;
    }
    return result;
}

/* Touches the cells around a removed leaf, which have lost links. */
static gx_result gxp_touch_around(gx_body *body, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const gxb_facet *f = gxb_complex_facet(cx, gxp_item(cx, first + i));
        const uint32_t other = f->leaf[f->leaf[0] == leaf];
        if (gxp_is_kept(body, other)) result = gxp_push(body, &body->scratch.touched, body->leaves.data[other].cell);
    }
    return result;
}

/* Lists the links again after some were severed. Cells beside these join the new ones. */
static gx_result gxp_touch_severed(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    gx_result result = gxp_collect_touched(cut);
    uint32_t i;
    for (i = 0; i < scratch->touched.count && result == GX_OK; i++) {
        const uint32_t cell = scratch->touched.data[i];
        if (body->cells.data[cell].kept && gxp_new_index(body, cell) == GXP_NONE)
            result = gxp_push(body, &scratch->new_cells, cell);
    }
    scratch->links.count = scratch->link_first.count = scratch->interfaces.count = 0;
    scratch->stamp++;
    for (i = 0; i < scratch->new_cells.count && result == GX_OK; i++)
        result = gxp_walk_leaves(body, body->cells.data[scratch->new_cells.data[i]].first_leaf);
    return result == GX_OK ? gxp_settle_links(body) : result;
}

/* Prefetches the data that dividing the next touched cells will read: leaves four and three cells ahead, their lists of
   facets two ahead, the facets of the next. */
GXP_PREFETCHES void gxp_prefetch_leaves(const gx_body *body, uint32_t index) {
    const gxb_complex *cx = body->complex;
    const uint32_t *touched = body->scratch.touched.data, count = body->scratch.touched.count;
    uint32_t leaf, i;
    if (index + 4 < count && (leaf = body->cells.data[touched[index + 4]].first_leaf) != GXP_NONE) {
        GXP_PREFETCH(&body->leaves.data[leaf]);
        GXP_PREFETCH(gxb_complex_leaf(cx, leaf));
    }
    if (index + 3 < count)
        for (leaf = body->cells.data[touched[index + 3]].first_leaf; leaf != GXP_NONE;
             leaf = body->leaves.data[leaf].next)
            GXP_PREFETCH(gxb_complex_leaf(cx, leaf));
    if (index + 2 < count)
        for (leaf = body->cells.data[touched[index + 2]].first_leaf; leaf != GXP_NONE;
             leaf = body->leaves.data[leaf].next)
            GXP_PREFETCH(gxb_complex_list(cx, gxb_complex_leaf(cx, leaf)->facets));
    if (index + 1 < count)
        for (leaf = body->cells.data[touched[index + 1]].first_leaf; leaf != GXP_NONE;
             leaf = body->leaves.data[leaf].next)
            for (i = 0; i < gxb_complex_leaf(cx, leaf)->facet_count; i++)
                GXP_PREFETCH(gxb_complex_facet(cx, gxp_item(cx, gxb_complex_leaf(cx, leaf)->facets + i)));
}

/* Divides all touched cells, lists the new cells and their links. The list of touched cells stays. */
static gx_result gxp_divide_cells(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = gxp_log_room(body, &body->undo.cells, 4 * (size_t)scratch->touched.count);
    if (result == GX_OK) result = gxp_keys_room(body, &scratch->links, 16 * (size_t)scratch->touched.count);
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_CELLS, scratch->touched.count);
    if (result == GX_OK) result = gxp_start_words(body, &scratch->new_cells, 2 * (size_t)scratch->touched.count);
    if (result == GX_OK) result = gxp_start_words(body, &scratch->link_first, 2 * (size_t)scratch->touched.count);
    scratch->new_cells.count = scratch->links.count = scratch->link_first.count = scratch->interfaces.count = 0;
    scratch->stamp++;
    for (i = 0; i < scratch->touched.count && result == GX_OK; i++) {
        uint32_t *stamp = &body->cells.stamp[body->cells.data[scratch->touched.data[i]].element];
        cut->report.touched_elements += *stamp != scratch->stamp;
        *stamp = scratch->stamp;
    }
    for (i = 0; i < scratch->touched.count && result == GX_OK; i++) {
        gxp_prefetch_leaves(body, i);
        result = gxp_divide_cell(cut, scratch->touched.data[i]);
    }
    return result == GX_OK ? gxp_settle_links(body) : result;
}

/* >>components: nodal subdomains and their copies ------------------------------------------------------------------ */
/* A nodal subdomain is a connected set of cells around a node; each has a copy of its own (GXFEM Eq. 18). In: new cells
   and their links. Out: copies for the subdomains into which old ones fell apart, the copies that lost all cells.
   Touches cells, through the undo log, and appends copies. */

/* Visits the cell across one facet of an element's face. */
static gx_result gxp_cross_facet(gx_body *body, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = gxb_complex_facet(body->complex, facet);
    const uint32_t other = f->leaf[f->leaf[0] == leaf];
    if (other == GXB_NONE || body->cells.stamp[body->leaves.data[other].cell] == body->scratch.stamp ||
        !gxp_is_link(body, facet))
        return GX_OK;
    return gxp_visit_cell(body, body->leaves.data[other].cell, &body->scratch.subdomain_cells);
}

/* Visits the cells that are linked to the cell of a whole element across the face opposite to local node k. */
static gx_result gxp_cross_whole_face(gx_body *body, uint32_t element, uint32_t k) {
    gxp_scratch *scratch = &body->scratch;
    gxb_complex *cx = body->complex;
    const uint32_t face = gxb_complex_element_faces(cx, element)[k], other = gxp_neighbour(body, element, k);
    uint32_t i;
    gx_result result;
    if (other == GXP_NONE) return GX_OK;
    if (gxb_complex_face_facet(cx, face) == GXB_NONE)
        return gxp_is_kept(body, other) ? gxp_visit_cell(body, body->leaves.data[other].cell, &scratch->subdomain_cells)
                                        : GX_OK;
    scratch->face_facets.count = 0;
    result = gxp_push_divided_facets(body, gxb_complex_face_facet(cx, face), &scratch->face_facets);
    for (i = 0; i < scratch->face_facets.count && result == GX_OK; i++)
        result = gxp_cross_facet(body, scratch->face_facets.data[i], element);
    return result;
}

/* Visits the cells that are linked to a new cell across its element's faces around a node: all but the one opposite to
   local node k. Unless all is set it visits new cells only, and sets *open if there are others. */
static gx_result gxp_cross_links(gx_body *body, uint32_t index, uint32_t k, int all, uint32_t *open) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = GX_OK;
    for (i = scratch->link_first.data[index]; i < scratch->link_first.data[index + 1] && result == GX_OK; i++) {
        const uint32_t other = GXP_LINK_CELL(scratch->links.data[i]);
        if (GXP_LINK_FACE(scratch->links.data[i]) == k || body->cells.stamp[other] == scratch->stamp) continue;
        if (gxp_new_index(body, other) == GXP_NONE) *open = 1;
        if (all || gxp_new_index(body, other) != GXP_NONE)
            result = gxp_visit_cell(body, other, &scratch->subdomain_cells);
    }
    return result;
}

/* Visits the cells across interfaces from a new cell. As gxp_cross_links */
static gx_result gxp_cross_interfaces(gx_body *body, uint32_t index, int all, uint32_t *open) {
    gxp_scratch *scratch = &body->scratch;
    const gxp_keys *keys = &scratch->interfaces;
    uint32_t i = gxp_first_key(keys, (uint64_t)index << 32);
    gx_result result = GX_OK;
    for (; i < keys->count && GXP_FIRST(keys->data[i]) == index && result == GX_OK; i++) {
        const uint32_t other = GXP_SECOND(keys->data[i]);
        if (body->cells.stamp[other] == scratch->stamp) continue;
        if (gxp_new_index(body, other) == GXP_NONE) *open = 1;
        if (all || gxp_new_index(body, other) != GXP_NONE)
            result = gxp_visit_cell(body, other, &scratch->subdomain_cells);
    }
    return result;
}

/* Visits the cells that are linked to a cell that is not new, across the faces around the node and interfaces. */
static gx_result gxp_cross_faces(gx_body *body, uint32_t cell, uint32_t node) {
    gxb_complex *cx = body->complex;
    const uint32_t element = body->cells.data[cell].element;
    const uint32_t local = (uint32_t)gxp_local_node(body, element, node),
                   opposite = gxb_complex_element_faces(cx, element)[local];
    uint32_t leaf, first, count, i, k;
    gx_result result = GX_OK;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next) {
        if (gxb_complex_leaf(cx, leaf)->facet_count == 0) {
            for (k = 0; k < 4 && result == GX_OK; k++)
                if (k != local) result = gxp_cross_whole_face(body, element, k);
            continue;
        }
        result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const uint32_t facet = gxp_item(cx, first + i), face = gxb_complex_facet(cx, facet)->face;
            if (face != opposite && (face != GXB_NONE || gxp_is_mixed(body)))
                result = gxp_cross_facet(body, facet, leaf);
        }
    }
    return result;
}

/* Appends the cells of the nodal subdomain that contains the cell to scratch.subdomain_cells and stamps them. all 0:
   only those that new cells alone connect; *open: links lead on to others. */
static gx_result gxp_walk_subdomain(gx_body *body, uint32_t cell, uint32_t node, int all, uint32_t *open) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t done = scratch->subdomain_cells.count;
    gx_result result = gxp_visit_cell(body, cell, &scratch->subdomain_cells);
    *open = 0;
    while (done < scratch->subdomain_cells.count && result == GX_OK) {
        const uint32_t c = scratch->subdomain_cells.data[done++], index = gxp_new_index(body, c);
        if (index == GXP_NONE)
            result = gxp_cross_faces(body, c, node);
        else
            result = gxp_cross_links(body, index, (uint32_t)gxp_local_node(body, body->cells.data[c].element, node),
                                     all, open);
        if (result == GX_OK && index != GXP_NONE && scratch->interfaces.count > 0)
            result = gxp_cross_interfaces(body, index, all, open);
        if (result == GX_OK && body->mesh.node_pinched[node]) result = gxp_cross_joints(body, c);
    }
    return result;
}

/* Appends a copy of a node's displacement with the values of the one it comes from (GXFEM Algorithm 1, line 7). */
static gx_result gxp_new_copy(gx_body *body, uint32_t from, uint32_t *copy) {
    gx_result result = gxp_grow_rows(body, GXP_COPIES, 1);
    if (result != GX_OK) return result;
    *copy = body->copies.count++;
    gxp_copy_row(body, GXP_COPIES, from, *copy);
    body->copies.label[*copy] |= 1;
    body->copies.before[*copy] |= 1;
    if (!body->view.labels_known) return GX_OK;
    result = gxp_push(body, &body->view.splits, *copy);
    return result == GX_OK ? gxp_push(body, &body->view.splits, from) : result;
}

/* Gives a copy to the cells first ... end-1 of scratch.subdomain_cells. */
static gx_result gxp_set_copy(gx_body *body, uint32_t node, uint32_t copy, uint32_t first, uint32_t end) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = first; i < end && result == GX_OK; i++) {
        const uint32_t cell = body->scratch.subdomain_cells.data[i];
        result = gxp_save_cell(body, cell);
        if (result == GX_OK)
            body->cells.data[cell].copies[gxp_local_node(body, body->cells.data[cell].element, node)] = copy;
    }
    return result;
}

/* Pairs a cell with its nodes. */
static gx_result gxp_pair_cell(gx_body *body, uint32_t cell) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, body->cells.data[cell].element);
    uint32_t k;
    gx_result result = gxp_keys_room(body, &body->scratch.pairs, 4);
    for (k = 0; k < 4 && result == GX_OK; k++) result = gxp_push_key(body, &body->scratch.pairs, node[k], cell);
    return result;
}

/* Pairs a node with all cells around it. */
static gx_result gxp_pair_node(gx_body *body, uint32_t node) {
    uint32_t j, cell;
    gx_result result = GX_OK;
    for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1]; j++)
        for (cell = body->mesh.node_elements[j]; cell != GXP_NONE && result == GX_OK;
             cell = body->cells.data[cell].next)
            if (body->cells.data[cell].kept) result = gxp_push_key(body, &body->scratch.pairs, node, cell);
    return result;
}

/* Collects where the walks start: each new or removed cell, around each of its nodes. Around pinched nodes, where a
   wall may break a joint by a touch in one point, every cell. */
static gx_result gxp_collect_pairs(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = GX_OK;
    scratch->pairs.count = 0; /* room for twice as many: sorting takes as much again */
    result = gxp_keys_room(body, &scratch->pairs, 8 * (size_t)scratch->new_cells.count);
    for (i = 0; i < scratch->new_cells.count && result == GX_OK; i++)
        result = gxp_pair_cell(body, scratch->new_cells.data[i]);
    for (i = 0; i < scratch->touched.count && result == GX_OK; i++)
        if (!body->cells.data[scratch->touched.data[i]].kept) result = gxp_pair_cell(body, scratch->touched.data[i]);
    if (result == GX_OK) result = gxp_add_pinches(body, &scratch->pairs);
    for (i = 0; i < scratch->pinches.count && result == GX_OK; i++)
        result = gxp_pair_node(body, scratch->pinches.data[i]);
    return result == GX_OK ? gxp_sort_keys(body, &scratch->pairs, 0, scratch->pairs.count) : result;
}

/* Finds the subdomains around the node of pairs first ... end-1. Every part of a subdomain that fell apart contains a
   cell of a pair. Lists their cells in scratch.subdomain_cells, the start of each in scratch.subdomains, and in
   scratch.taken the copies that an open one keeps. all 0: walks through new cells only. That tells the subdomains
   apart, *sure, unless two open ones have the same copy. */
static gx_result gxp_find_subdomains(gx_body *body, uint32_t first, uint32_t end, int all, int *sure) {
    gxp_scratch *scratch = &body->scratch;
    const uint32_t node = GXP_FIRST(scratch->pairs.data[first]);
    uint32_t i, open;
    gx_result result = GX_OK;
    scratch->subdomain_cells.count = scratch->subdomains.count = scratch->taken.count = 0;
    scratch->stamp++;
    *sure = all || !body->mesh.node_pinched[node];
    if (*sure && body->mesh.node_pinched[node]) result = gxp_list_joints(body, node);
    for (i = first; i < end && result == GX_OK && *sure; i++) {
        const uint32_t cell = GXP_SECOND(scratch->pairs.data[i]), start = scratch->subdomain_cells.count,
                       copy = gxp_copy_of(body, cell, node);
        if (!body->cells.data[cell].kept || body->cells.stamp[cell] == scratch->stamp) continue;
        result = gxp_walk_subdomain(body, cell, node, all, &open);
        if (open && gxp_contains(&scratch->taken, copy)) {
            *sure = all;
            open = 0;
        }
        if (result == GX_OK && open) result = gxp_push(body, &scratch->taken, copy);
        if (result == GX_OK) result = gxp_push(body, &scratch->subdomains, start << 1 | open);
    }
    return result;
}

/* Gives each subdomain around a node a copy of its own. Of those that came from one, the open one keeps the old copy,
   or else the first. Old copies without cells are listed in scratch.dead. */
static gx_result gxp_divide_node(gxp_cut *cut, uint32_t first, uint32_t end) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const uint32_t node = GXP_FIRST(scratch->pairs.data[first]);
    uint32_t i;
    int sure = 0;
    gx_result result = gxp_find_subdomains(body, first, end, 0, &sure);
    if (result == GX_OK && !sure) result = gxp_find_subdomains(body, first, end, 1, &sure);
    for (i = 0; i < scratch->subdomains.count && result == GX_OK; i++) {
        const uint32_t from = scratch->subdomains.data[i] >> 1, to = i + 1 < scratch->subdomains.count
                                                                       ? scratch->subdomains.data[i + 1] >> 1
                                                                       : scratch->subdomain_cells.count;
        const uint32_t old = gxp_copy_of(body, scratch->subdomain_cells.data[from], node);
        uint32_t copy;
        if (scratch->subdomains.data[i] & 1) continue;
        if (!gxp_contains(&scratch->taken, old)) {
            result = gxp_push(body, &scratch->taken, old);
            continue;
        }
        result = gxp_new_copy(body, old, &copy);
        if (result == GX_OK) result = gxp_set_copy(body, node, copy, from, to);
        cut->report.created_copies++;
    }
    for (i = first; i < end && result == GX_OK; i++) {
        const uint32_t cell = GXP_SECOND(scratch->pairs.data[i]), old = gxp_copy_of(body, cell, node);
        if (!body->cells.data[cell].kept && !gxp_contains(&scratch->taken, old) && !gxp_contains(&scratch->dead, old))
            result = gxp_push(body, &scratch->dead, old);
    }
    return result;
}

/* Gives copies to the subdomains around all nodes of new and removed cells. */
static gx_result gxp_divide_nodes(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    uint32_t first, end;
    gx_result result = gxp_collect_pairs(body);
    scratch->dead.count = 0;
    for (first = 0; first < scratch->pairs.count && result == GX_OK; first = end) {
        for (end = first;
             end < scratch->pairs.count && GXP_FIRST(scratch->pairs.data[end]) == GXP_FIRST(scratch->pairs.data[first]);
             end++) {}
        result = gxp_divide_node(cut, first, end);
    }
    return result;
}

/* >>integrals: volume and mass of cells ---------------------------------------------------------------------------- */
/* In: cells and leaves. Out: their volumes and mass matrices, by the triangles of their boundary in barycentric
   coordinates of the element. Sums whose terms cancel are summed in exact numbers. Touches cells, through the undo log.
 */

/* So many points are kept at most: they should stay in the cache. */
#define GXP_BOUNDARY_POINTS 16384u

/* Empties the boundary. Points are kept while the element stays the same: its cells share those of its walls. */
static void gxp_clear_boundary(gx_body *body, int other_element) {
    gxp_scratch *scratch = &body->scratch;
    gxp_boundary *boundary = &scratch->boundary;
    if (other_element || boundary->points.count > GXP_BOUNDARY_POINTS) boundary->points.count = 0;
    boundary->triangles.count = boundary->facets.count = boundary->leaves.count = 0;
}

/* Adds a point of the complex with its barycentric coordinates in the element. */
static gx_result gxp_new_boundary_point(gx_body *body, uint32_t element, uint32_t point, uint32_t *index) {
    gxp_boundary *boundary = &body->scratch.boundary;
    gx_result result = GX_OK;
    if (point >= boundary->slots.count) {
        result = gxp_words_room(body, &boundary->slots, gxb_complex_point_count(body->complex) - boundary->slots.count);
        if (result != GX_OK) return result;
        memset(boundary->slots.data + boundary->slots.count, 0xff,
               (gxb_complex_point_count(body->complex) - boundary->slots.count) * sizeof(uint32_t));
        boundary->slots.count = gxb_complex_point_count(body->complex);
    }
    result = gxp_reserve(&body->config.allocator, &boundary->lambdas, 4 * sizeof(double), boundary->points.count,
                         &boundary->lambda_capacity, 1);
    *index = boundary->points.count;
    if (*index == 0) boundary->fixed_count = 0;
    boundary->fixed_of.count = *index;
    if (result == GX_OK) result = gxp_push(body, &boundary->fixed_of, GXP_NONE);
    if (result == GX_OK) result = gxp_push(body, &boundary->points, point);
    if (result != GX_OK) return result;
    boundary->slots.data[point] = *index;
    gxb_complex_barycentric(body->complex, point, element, boundary->lambdas + 4 * (size_t)*index);
    return GX_OK;
}

/* *index: the place of a point of the complex in the boundary's points; it is added if it is new. */
static gx_result gxp_add_boundary_point(gx_body *body, uint32_t element, uint32_t point, uint32_t *index) {
    gxp_boundary *boundary = &body->scratch.boundary;
    *index = point < boundary->slots.count ? boundary->slots.data[point] : GXP_NONE;
    return *index < boundary->points.count && boundary->points.data[*index] == point
             ? GX_OK
             : gxp_new_boundary_point(body, element, point, index);
}

/* Adds a facet as a fan of triangles; inward: the material is in front of it. */
static gx_result gxp_add_boundary_facet(gx_body *body, uint32_t element, uint32_t facet, int inward) {
    gxp_boundary *boundary = &body->scratch.boundary;
    gxb_complex *cx = body->complex;
    uint32_t e0, en, i, corner[3] = {0, 0, 0};
    gx_result result = gxb_facet_resolve_edges(cx, facet, &e0, &en);
    if (result == GX_OK) result = gxp_words_room(body, &boundary->triangles, 3 * (size_t)en);
    for (i = 0; i < en && result == GX_OK; i++) {
        const uint32_t e = gxp_item(cx, e0 + i);
        uint32_t *triangle = boundary->triangles.data + boundary->triangles.count;
        result = gxp_add_boundary_point(body, element, gxb_complex_edge_start(cx, e), &corner[i < 2 ? i : 2]);
        if (i < 2) continue;
        triangle[0] = corner[0];
        triangle[inward ? 2 : 1] = corner[1];
        triangle[inward ? 1 : 2] = corner[2];
        boundary->triangles.count += 3;
        corner[1] = corner[2];
    }
    return result;
}

/* Adds the facets of a leaf inside the element. Those that cancel are left out: they have the same cell on both sides
   or, where stamp is not 0, two leaves that are marked with it. Facets in faces of the element are only listed, in
   facets. */
static gx_result gxp_add_boundary_leaf(gx_body *body, uint32_t leaf, uint32_t stamp) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    if (result == GX_OK) result = gxp_push(body, &body->scratch.boundary.leaves, leaf);
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = gxp_item(cx, first + i);
        const gxb_facet *f = gxb_complex_facet(cx, facet);
        const int inward = f->leaf[0] == leaf;
        const uint32_t other = f->leaf[inward];
        if (f->face != GXB_NONE)
            result = gxp_push(body, &body->scratch.boundary.facets, facet << 1 | (uint32_t)inward);
        else if (stamp != 0
                     ? body->leaves.mark[other].stamp != stamp
                     : !gxp_is_kept(body, other) || body->leaves.data[other].cell != body->leaves.data[leaf].cell)
            result = gxp_add_boundary_facet(body, gxb_complex_leaf(cx, leaf)->element, facet, inward);
    }
    return result;
}

/* The coordinates of one of the boundary's points along three axes, with 184 bits behind the point */
static gx_result gxp_fixed_coordinates(gx_body *body, uint32_t element, uint32_t point, const unsigned axes[3],
                                       gxb_fixed x[3]) {
    gxp_boundary *boundary = &body->scratch.boundary;
    uint32_t *place = &boundary->fixed_of.data[point];
    int c;
    if (*place == GXP_NONE) {
        const gx_result result = gxp_reserve(&body->config.allocator, &boundary->fixed, 4 * sizeof *boundary->fixed,
                                             boundary->fixed_count, &boundary->fixed_capacity, 1);
        if (result != GX_OK) return result;
        *place = boundary->fixed_count++;
        gxb_complex_barycentric_fixed(body->complex, boundary->points.data[point], element,
                                      boundary->fixed + 4 * (size_t)*place);
    }
    for (c = 0; c < 3; c++) x[c] = boundary->fixed[4 * (size_t)*place + axes[c]];
    return GX_OK;
}

/* Adds the moments of a tetrahedron of which six times the volume is D: D / 6, D s_i / 24, D (s_i s_j + the sum of
   products x_i x_j of its corners x) / 120, where s is their sum. */
static void gxp_add_tetrahedron(const double *x[4], const unsigned axes[3], double D, gxi_moments2 *m) {
    double s[3], q;
    int i, j, n, slot = 0;
    for (i = 0; i < 3; i++) {
        s[i] = x[0][axes[i]] + x[1][axes[i]] + x[2][axes[i]] + x[3][axes[i]];
        m->first[i] += D * s[i] / 24;
    }
    m->volume += D / 6;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) {
            q = s[i] * s[j];
            for (n = 0; n < 4; n++) q += x[n][axes[i]] * x[n][axes[j]];
            m->second[slot++] += D * q / 120;
        }
}

/* Adds the moments of a leaf in the frame with origin k, by tetrahedra from one of its corners to its triangles. The
   leaf is convex, so no volume is negative and nothing cancels; volumes are exact. *count: of tetrahedra */
static gx_result gxp_add_leaf_moments(gx_body *body, uint32_t element, uint32_t leaf, unsigned k, gxi_moments2 *m,
                                      uint32_t *count) {
    gxp_boundary *boundary = &body->scratch.boundary;
    const uint32_t start = boundary->triangles.count;
    gxb_complex *cx = body->complex;
    unsigned axes[3];
    gxb_fixed x[4][3];
    uint32_t first, facets, i, j, o;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &facets);
    for (i = 0; i < facets && result == GX_OK; i++) {
        const uint32_t facet = gxp_item(cx, first + i);
        result = gxp_add_boundary_facet(body, element, facet, gxb_complex_facet(cx, facet)->leaf[0] == leaf);
    }
    gxi_part_axes(k, axes);
    o = boundary->triangles.data[start];
    if (result == GX_OK) result = gxp_fixed_coordinates(body, element, o, axes, x[3]);
    for (i = start; i < boundary->triangles.count && result == GX_OK; i += 3) {
        const uint32_t *t = boundary->triangles.data + i;
        const double *corner[4];
        if (t[0] == o || t[1] == o || t[2] == o) continue;
        for (j = 0; j < 3 && result == GX_OK; j++) result = gxp_fixed_coordinates(body, element, t[j], axes, x[j]);
        if (result != GX_OK) break;
        for (j = 0; j < 3; j++) corner[j] = boundary->lambdas + 4 * (size_t)t[j];
        corner[3] = boundary->lambdas + 4 * (size_t)o;
        gxp_add_tetrahedron(corner, axes, gxb_fixed_determinant(x[3], x[0], x[1], x[2]), m);
        (*count)++;
    }
    boundary->triangles.count = start;
    return result;
}

/* The error of a tetrahedron's determinant, from six errors of 2^-179 in each of three edges of length 1 at most, is
   this share of a volume that it moves by less than its last digits. */
#define GXP_FIXED_VOLUME 7.5e-37 /* 2^-120 */

/* Moments of the leaves that the boundary bounds. *enough: whether the volume is right to its last digits */
static gx_result gxp_leaf_moments(gx_body *body, uint32_t element, unsigned k, gxi_moments2 *m, int *enough) {
    const gxp_words *leaves = &body->scratch.boundary.leaves;
    uint32_t i, count = 0;
    gx_result result = GX_OK;
    memset(m, 0, sizeof *m);
    for (i = 0; i < leaves->count && result == GX_OK; i++)
        result = gxp_add_leaf_moments(body, element, leaves->data[i], k, m, &count);
    *enough = m->volume > GXP_FIXED_VOLUME * count;
    return result;
}

typedef struct gxp_fine_sums {
    gxb_num c[10];
    gxb_limb limbs[10][GXB_NUM_LIMBS];
} gxp_fine_sums;
/* det(a, b, c) */
static GXP_APART void gxp_fine_determinant(gxb_num *det, gxb_num *p[3][3]) {
    static const int cyclic[3][2] = {{1, 2}, {2, 0}, {0, 1}};
    int k;
    det->sign = det->exp = 0;
    det->n = 0;
    for (k = 0; k < 3; k++) {
        GXB_NUM(s);
        GXB_NUM(t);
        GXB_NUM(u);
        gxb_num_mul(&s, p[1][cyclic[k][0]], p[2][cyclic[k][1]]);
        gxb_num_mul(&t, p[1][cyclic[k][1]], p[2][cyclic[k][0]]);
        gxb_num_sub(&u, &s, &t);
        gxp_num_add_product(det, p[0][k], &u);
    }
}

/* Adds the cone from the origin to a triangle. With D = det(a,b,c), s = a+b+c: D, D s_i, D (s_i s_j + a_i a_j + b_i b_j
   + c_i c_j). */
static GXP_APART void gxp_fine_add(gxp_fine_sums *sums, gxb_num *p[3][3]) {
    gxb_limb limbs[3][GXB_NUM_LIMBS];
    gxb_num s[3];
    int i, j, k, slot = 4;
    GXB_NUM(det);
    GXB_NUM(one);
    gxp_fine_determinant(&det, p);
    gxb_num_set(&one, 1.0, 0);
    gxp_num_add_product(&sums->c[0], &det, &one);
    for (i = 0; i < 3; i++) {
        s[i].sign = s[i].exp = 0;
        s[i].n = 0;
        s[i].d = limbs[i];
        for (k = 0; k < 3; k++) gxp_num_add_product(&s[i], p[k][i], &one);
        gxp_num_add_product(&sums->c[1 + i], &det, &s[i]);
    }
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++, slot++) {
            GXB_NUM(q);
            for (k = 0; k < 3; k++) gxp_num_add_product(&q, p[k][i], p[k][j]);
            gxp_num_add_product(&q, &s[i], &s[j]);
            gxp_num_add_product(&sums->c[slot], &det, &q);
        }
}

/* The exact coordinates of one of the boundary's points, computed once */
static void gxp_fine_coordinates(gx_body *body, uint32_t element, uint32_t point, gxp_fine_point *points) {
    int a;
    if (points[point].c[0].d != NULL) return;
    for (a = 0; a < 4; a++) points[point].c[a].d = points[point].limbs[a];
    gxb_complex_barycentric_fine(body->complex, body->scratch.boundary.points.data[point], element, points[point].c);
}

/* Moments of the boundary's triangles, from the coordinates of its points along three axes */
static GXP_APART void gxp_fine_sum(const gxp_boundary *boundary, gxp_fine_point *points, const unsigned *axes,
                                   gxi_moments2 *m) {
    gxp_fine_sums sums;
    uint32_t i, t;
    int a, c;
    for (i = 0; i < 10; i++) {
        sums.c[i].sign = sums.c[i].exp = 0;
        sums.c[i].n = 0;
        sums.c[i].d = sums.limbs[i];
    }
    for (t = 0; t + 2 < boundary->triangles.count; t += 3) {
        gxb_num *p[3][3];
        for (a = 0; a < 3; a++)
            for (c = 0; c < 3; c++) p[a][c] = &points[boundary->triangles.data[t + (uint32_t)a]].c[axes[c]];
        gxp_fine_add(&sums, p);
    }
    m->volume = gxb_num_to_double(&sums.c[0]) / 6;
    for (a = 0; a < 3; a++) m->first[a] = gxb_num_to_double(&sums.c[1 + a]) / 24;
    for (a = 0; a < 6; a++) m->second[a] = gxb_num_to_double(&sums.c[4 + a]) / 120;
}

/* Moments of the boundary in the frame with origin k, from coordinates with 180 bits. */
static gx_result gxp_fine_moments(gx_body *body, uint32_t element, unsigned k, gxi_moments2 *m) {
    const gxp_boundary *boundary = &body->scratch.boundary;
    const size_t size = boundary->points.count * sizeof(gxp_fine_point);
    gxp_fine_point *points = (gxp_fine_point *)gxp_allocate(&body->config.allocator, size);
    unsigned axes[3];
    uint32_t i;
    if (points == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < boundary->points.count; i++) points[i].c[0].d = NULL;
    for (i = 0; i < boundary->triangles.count; i++)
        gxp_fine_coordinates(body, element, boundary->triangles.data[i], points);
    gxi_part_axes(k, axes);
    gxp_fine_sum(boundary, points, axes, m);
    gxp_release(&body->config.allocator, points, size);
    return GX_OK;
}

/* Moments whose terms cancel to less than this share are summed in exact numbers: doubles lose 3 digits there. */
#define GXP_CANCELLATION 1e-3

/* The size of the terms in the volumes of the cones from vertex k to the triangles, a . (b - a) x (c - a). The errors
   of the corners weigh as much and no more: the triangles close a surface, up to faces through k, and share their
   corners. So the error of a corner moves the volume by its product with the area of the triangles around it. */
static double gxp_cone_volumes(const gx_body *body, unsigned k) {
    const gxp_boundary *boundary = &body->scratch.boundary;
    unsigned axes[3], d;
    double sum = 0;
    uint32_t t;
    gxi_part_axes(k, axes);
    for (t = 0; t + 2 < boundary->triangles.count; t += 3) {
        const double *a = boundary->lambdas + 4 * (size_t)boundary->triangles.data[t],
                     *b = boundary->lambdas + 4 * (size_t)boundary->triangles.data[t + 1];
        const double *c = boundary->lambdas + 4 * (size_t)boundary->triangles.data[t + 2];
        for (d = 0; d < 3; d++) {
            const unsigned x = axes[d], y = axes[(d + 1) % 3], z = axes[(d + 2) % 3];
            sum +=
                (a[x] + b[x] + c[x]) * (fabs(b[y] - a[y]) * fabs(c[z] - a[z]) + fabs(b[z] - a[z]) * fabs(c[y] - a[y]));
        }
    }
    return sum / 6;
}

/* The vertex of the element with the largest barycentric coordinates over the triangles */
static unsigned gxp_nearest_vertex(const gx_body *body) {
    const gxp_boundary *boundary = &body->scratch.boundary;
    double sum[4] = {0, 0, 0, 0};
    unsigned nearest = 0, k;
    uint32_t i;
    for (i = 0; i < boundary->triangles.count; i++)
        for (k = 0; k < 4; k++) sum[k] += boundary->lambdas[4 * (size_t)boundary->triangles.data[i] + k];
    for (k = 1; k < 4; k++)
        if (sum[k] > sum[nearest]) nearest = k;
    return nearest;
}

/* Moments of the boundary; *k: the vertex of the element that is their origin. Of the facets in the element's faces,
   only those in the face opposite to k span cones. */
static gx_result gxp_boundary_moments(gx_body *body, uint32_t element, unsigned *k, gxi_moments2 *m) {
    gxp_boundary *boundary = &body->scratch.boundary;
    const gxb_complex *cx = body->complex;
    uint32_t i;
    int enough;
    gx_result result = GX_OK;
    *k = gxp_nearest_vertex(body);
    for (i = 0; i < boundary->facets.count && result == GX_OK; i++) {
        const uint32_t facet = boundary->facets.data[i] >> 1;
        if (gxb_complex_facet(cx, facet)->face == gxb_complex_element_faces(cx, element)[*k])
            result = gxp_add_boundary_facet(body, element, facet, (int)(boundary->facets.data[i] & 1));
    }
    if (result == GX_OK)
        result = gxi_part_moments_at(boundary->lambdas, boundary->points.count, boundary->triangles.data,
                                     boundary->triangles.count / 3, *k, m);
    if (result != GX_OK || m->volume >= GXP_CANCELLATION * gxp_cone_volumes(body, *k)) return result;
    result = gxp_leaf_moments(body, element, *k, m, &enough);
    return result == GX_OK && !enough ? gxp_fine_moments(body, element, *k, m) : result;
}

/* The volume and mass of a cell; volume: of its element */
static gx_result gxp_integrate_cell(gx_body *body, uint32_t cell, double volume) {
    const uint32_t element = body->cells.data[cell].element;
    gxi_moments2 m;
    unsigned k;
    uint32_t leaf;
    gx_result result = gxp_save_cell(body, cell);
    gxp_clear_boundary(body, 0);
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next)
        result = gxp_add_boundary_leaf(body, leaf, 0);
    if (result == GX_OK) result = gxp_boundary_moments(body, element, &k, &m);
    if (result != GX_OK) return result;
    body->cells.data[cell].volume = 6 * volume * m.volume;
    gxi_part_mass(&m, k, volume, gxp_density(body, &body->cells.data[cell]), body->cells.data[cell].mass);
    return GX_OK;
}

static uint32_t gxp_count_leaves(const gx_body *body, uint32_t cell) {
    uint32_t leaf, count = 0;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE; leaf = body->leaves.data[leaf].next) count++;
    return count;
}

/* The leaf that contains the middle of the element, roughly */
static uint32_t gxp_middle_leaf(const gxb_complex *cx, uint32_t element) {
    uint32_t reference = gxb_complex_root(cx, element), n;
    double middle[3] = {0, 0, 0};
    int k;
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++)
            middle[k] += 0.25 * gxb_complex_point(cx, gxb_complex_element_nodes(cx, element)[n])->ball.x[k];
    while (reference & 1) {
        const gxb_node *node = gxb_complex_tree_node(cx, reference >> 1);
        const gxb_plane_filter *f = &gxb_complex_plane(cx, node->plane)->filter;
        double height = 0;
        for (k = 0; k < 3; k++) height += f->n[k] * (middle[k] - f->base[k]);
        reference = node->child[height > 0 ? 0 : 1];
    }
    return reference >> 1;
}

/* The cell in the middle of the element, which is seldom small. GXP_NONE if it is not new, if something was removed
   from the element, so that its cells do not fill it, or if its other cells have more leaves than its new ones. */
static uint32_t gxp_rest_cell(const gx_body *body, uint32_t element) {
    const uint32_t root = gxb_complex_root(body->complex, element),
                   all = root & 1 ? gxb_complex_tree_node(body->complex, root >> 1)->leaves : 1;
    const uint32_t rest = body->leaves.data[gxp_middle_leaf(body->complex, element)].cell;
    uint32_t cell, leaf, sum = 0, others = 0;
    if (gxp_new_index(body, rest) == GXP_NONE) return GXP_NONE;
    for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        if (gxp_new_index(body, cell) != GXP_NONE) sum += gxp_count_leaves(body, cell);
    for (cell = element; cell != GXP_NONE && others <= sum; cell = body->cells.data[cell].next) {
        if (gxp_new_index(body, cell) != GXP_NONE) continue;
        for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && others <= sum;
             leaf = body->leaves.data[leaf].next)
            others++;
    }
    return others <= sum && sum + others == all ? rest : GXP_NONE;
}

/* An element with more cells is not integrated as a whole: a cut may touch few of them. */
#define GXP_REST_CELLS 4
/* A cell with at least this share of its element may be computed as the rest; its smallest moments lose two digits. */
#define GXP_REST 0.25

/* Sets a cell, which was logged, to the element less its other cells. Returns 0 if too little remains. */
static int gxp_leave_rest(gx_body *body, uint32_t rest, double volume) {
    const uint32_t element = body->cells.data[rest].element;
    const double density = gxp_density(body, &body->cells.data[rest]);
    double mass[10], left = volume;
    uint32_t cell;
    int i;
    gxi_tet_mass(volume, density, mass);
    for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next) {
        const double ratio = density / gxp_density(body, &body->cells.data[cell]); /* exactly 1 if it is of the same */
        if (cell == rest) continue;
        left -= body->cells.data[cell].volume;
        for (i = 0; i < 10; i++) mass[i] -= ratio * body->cells.data[cell].mass[i];
    }
    if (!(left >= GXP_REST * volume)) return 0;
    body->cells.data[rest].volume = left;
    memcpy(body->cells.data[rest].mass, mass, sizeof mass);
    return 1;
}

static int gxp_has_few_cells(const gx_body *body, uint32_t element) {
    uint32_t cell = element, count = 0;
    for (; cell != GXP_NONE && count <= GXP_REST_CELLS; cell = body->cells.data[cell].next) count++;
    return count <= GXP_REST_CELLS;
}

/* Integrates the new cells of an element. The one in the middle is most often computed as the rest. */
static gx_result gxp_integrate_element(gx_body *body, uint32_t element) {
    const double volume = gxp_element_volume(body, element);
    const uint32_t rest = gxp_rest_cell(body, element);
    uint32_t cell;
    int done = 0;
    gx_result result = gxb_complex_open_element(body->complex, element);
    for (cell = element; cell != GXP_NONE && result == GX_OK; cell = body->cells.data[cell].next)
        if (cell != rest && gxp_new_index(body, cell) != GXP_NONE) result = gxp_integrate_cell(body, cell, volume);
    if (rest == GXP_NONE || result != GX_OK) return result;
    result = gxp_save_cell(body, rest);
    if (result == GX_OK) done = gxp_leave_rest(body, rest, volume);
    return result != GX_OK || done ? result : gxp_integrate_cell(body, rest, volume);
}

/* The volume that the cut removed, element by element, so that a thin slab keeps its digits */
static gx_result gxp_integrate_removed(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    gxp_keys *removed = &scratch->removed_of;
    uint32_t i;
    gx_result result = GX_OK;
    removed->count = 0;
    if (scratch->removed.count > 0) scratch->stamp++;
    for (i = 0; i < scratch->removed.count && result == GX_OK; i++) {
        const uint32_t leaf = scratch->removed.data[i];
        body->leaves.mark[leaf].stamp = scratch->stamp;
        result = gxp_push_key(body, removed, gxb_complex_leaf(body->complex, leaf)->element, leaf);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, removed, 0, removed->count);
    for (i = 0; i < removed->count && result == GX_OK;) {
        const uint32_t element = GXP_FIRST(removed->data[i]);
        gxi_moments2 m;
        unsigned k;
        gxp_clear_boundary(body, 1);
        for (; i < removed->count && GXP_FIRST(removed->data[i]) == element && result == GX_OK; i++)
            result = gxp_add_boundary_leaf(body, GXP_SECOND(removed->data[i]), scratch->stamp);
        if (result == GX_OK) result = gxp_boundary_moments(body, element, &k, &m);
        if (result == GX_OK) cut->report.removed_volume += 6 * m.volume * gxp_element_volume(body, element);
    }
    return result;
}

/* >>sheets: what is thinner than its elements ---------------------------------------------------------------------- */
/* In: the cells of a cut, with their copies and masses. Out: the copies that become affine. A cell is thin if in some
   direction the material around it varies less, and in another one does not, than affine_below elements in a row would:
   a chip that is small in all directions does not bend. That material is counted copy by copy, over the copies of all
   cells that share a copy with the cell, so that a slice beside a thick part is not thin. It is compared with the
   elements themselves, so that a plate of flat elements is as thin as one of cubes. Touches working memory; a commit
   flags the copies. */

/* Variance of elements in a row, as a multiple of the mean variance of one. Unit cubes of five or six elements have
   1/24 along each axis, and a layer of them 1/12 across. So a layer has a thickness of sqrt(2 / 2.25) = 0.94, off the
   usual 1 by enough that rounding does not decide. */
#define GXP_ELEMENT_SPREAD 2.25

/* sum += factor x x^T */
static void gxp_add_square(const double x[3], double factor, double sum[6]) {
    sum[0] += factor * x[0] * x[0];
    sum[1] += factor * x[0] * x[1];
    sum[2] += factor * x[0] * x[2];
    sum[3] += factor * x[1] * x[1];
    sum[4] += factor * x[1] * x[2];
    sum[5] += factor * x[2] * x[2];
}

static void gxp_add_bulk(const gxp_bulk *from, gxp_bulk *sum) {
    int k;
    sum->volume += from->volume;
    sum->whole += from->whole;
    for (k = 0; k < 3; k++) sum->first[k] += from->first[k];
    for (k = 0; k < 6; k++) {
        sum->second[k] += from->second[k];
        sum->shape[k] += from->shape[k];
    }
}

/* Adds a cell and its element. sum_ij m_ij x_i x_j^T from the mass block: its diagonal less what pairs of corners lack.
 */
static void gxp_add_cell_bulk(const gx_body *body, const gxp_cell *cell, gxp_bulk *bulk) {
    static const uint8_t at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    const double density = gxp_density(body, cell), whole = gxp_element_volume(body, cell->element);
    const double *low = body->mesh.boxes[0].low;
    double x[12], middle[3];
    int i, j, k;
    gxp_element_positions(body, cell->element, x);
    for (k = 0; k < 3; k++) {
        middle[k] = (x[k] + x[3 + k] + x[6 + k] + x[9 + k]) / 4;
        for (i = 0; i < 4; i++) x[3 * i + k] -= low[k];
        middle[k] -= low[k];
    }
    for (i = 0; i < 4; i++) {
        double mean[3] = {0, 0, 0}, way[3];
        for (j = 0; j < 4; j++) {
            const double share = cell->mass[at[i][j]] / density;
            bulk->volume += share;
            for (k = 0; k < 3; k++) mean[k] += share * x[3 * j + k];
        }
        for (k = 0; k < 3; k++) {
            bulk->first[k] += mean[k];
            way[k] = x[3 * i + k] - middle[k];
        }
        bulk->second[0] += x[3 * i] * mean[0];
        bulk->second[1] += x[3 * i] * mean[1];
        bulk->second[2] += x[3 * i] * mean[2];
        bulk->second[3] += x[3 * i + 1] * mean[1];
        bulk->second[4] += x[3 * i + 1] * mean[2];
        bulk->second[5] += x[3 * i + 2] * mean[2];
        gxp_add_square(way, whole / 20, bulk->shape);
    }
    bulk->whole += whole;
}

static int gxp_is_definite(const double a[6]) {
    const double minor = a[0] * a[3] - a[1] * a[1];
    return a[0] > 0 && minor > 0 && minor * a[5] - a[0] * a[4] * a[4] + 2 * a[1] * a[2] * a[4] - a[3] * a[2] * a[2] > 0;
}

/* 1: thinner than `below` elements in a row, in some direction; 2: in all directions; 0: in none */
static int gxp_thinness(const gxp_bulk *bulk, double below) {
    static const uint8_t row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    double more[6], less[6];
    int k;
    if (!(bulk->volume > 0) || !(bulk->whole > 0)) return 0;
    for (k = 0; k < 6; k++) {
        more[k] = bulk->second[k] / bulk->volume -
                  bulk->first[row[k]] / bulk->volume * (bulk->first[column[k]] / bulk->volume) -
                  GXP_ELEMENT_SPREAD * below * below * bulk->shape[k] / bulk->whole;
        less[k] = -more[k];
    }
    return gxp_is_definite(more) ? 0 : gxp_is_definite(less) ? 2 : 1;
}

/* *bulk: what is around a copy. It is found once in a call; the pointer is good until the next call. */
static gx_result gxp_copy_bulk(gx_body *body, uint32_t copy, const gxp_bulk **bulk) {
    gxp_scratch *scratch = &body->scratch;
    gxp_around around = gxp_around_copy(body, copy);
    if (scratch->bulk_of.data[copy] == GXP_NONE) {
        const gx_result result = gxp_reserve(&body->config.allocator, &scratch->bulks, sizeof *scratch->bulks,
                                             scratch->bulk_count, &scratch->bulk_capacity, 1);
        if (result != GX_OK) return result;
        memset(&scratch->bulks[scratch->bulk_count], 0, sizeof *scratch->bulks);
        while (gxp_next_around(body, &around))
            gxp_add_cell_bulk(body, &body->cells.data[around.cell], &scratch->bulks[scratch->bulk_count]);
        scratch->bulk_of.data[copy] = scratch->bulk_count++;
    }
    *bulk = &scratch->bulks[scratch->bulk_of.data[copy]];
    return GX_OK;
}

/* What is around all copies of the cells that share a copy with the cell. walk: names it in bulk_met */
static gx_result gxp_cell_bulk(gx_body *body, uint32_t cell, uint32_t walk, gxp_bulk *sum) {
    uint32_t *met = body->scratch.bulk_met.data;
    gx_result result = GX_OK;
    int i, k;
    memset(sum, 0, sizeof *sum);
    for (i = 0; i < 4; i++) {
        gxp_around around = gxp_around_copy(body, body->cells.data[cell].copies[i]);
        while (result == GX_OK && gxp_next_around(body, &around))
            for (k = 0; k < 4 && result == GX_OK; k++) {
                const uint32_t copy = body->cells.data[around.cell].copies[k];
                const gxp_bulk *bulk;
                if (met[copy] == walk) continue;
                met[copy] = walk;
                result = gxp_copy_bulk(body, copy, &bulk);
                if (result == GX_OK) gxp_add_bulk(bulk, sum);
            }
    }
    return result;
}

/* Adds the copies of a cell to scratch.bent if it is thin. What is around each of its copies must be thin too: that is
   soon known. */
static gx_result gxp_judge_cell(gx_body *body, uint32_t cell, uint32_t walk) {
    const uint32_t *copies = body->cells.data[cell].copies;
    const uint8_t *affine = body->copies.affine;
    gx_result result = GX_OK;
    gxp_bulk sum;
    int k, thin = !(affine[copies[0]] & affine[copies[1]] & affine[copies[2]] & affine[copies[3]]);
    for (k = 0; k < 4 && thin && result == GX_OK; k++) {
        const gxp_bulk *bulk;
        result = gxp_copy_bulk(body, copies[k], &bulk);
        thin = result == GX_OK && gxp_thinness(bulk, body->config.affine_below) != 0;
    }
    if (!thin || result != GX_OK) return result;
    result = gxp_cell_bulk(body, cell, walk, &sum);
    if (result != GX_OK || gxp_thinness(&sum, body->config.affine_below) != 1) return result;
    for (k = 0; k < 4 && result == GX_OK; k++)
        if (!affine[copies[k]]) result = gxp_push(body, &body->scratch.bent, copies[k]);
    return result;
}

/* Nothing has been looked at yet. */
static gx_result gxp_start_sheets(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    const uint32_t count = body->copies.count;
    gx_result result = gxp_start_words(body, &scratch->bulk_of, count);
    if (result == GX_OK) result = gxp_start_words(body, &scratch->bulk_met, count);
    scratch->bent.count = scratch->sheet_cells.count = scratch->bulk_count = 0;
    if (result != GX_OK || count == 0) return result;
    memset(scratch->bulk_of.data, 0xff, count * sizeof(uint32_t));
    memset(scratch->bulk_met.data, 0, count * sizeof(uint32_t));
    scratch->stamp++;
    return GX_OK;
}

/* Lists the cells around the copies of a cell. */
static gx_result gxp_list_near(gx_body *body, uint32_t cell) {
    uint32_t *met = body->scratch.bulk_met.data;
    gx_result result = GX_OK;
    int k;
    for (k = 0; k < 4 && body->cells.data[cell].kept; k++) {
        const uint32_t copy = body->cells.data[cell].copies[k];
        gxp_around around = gxp_around_copy(body, copy);
        if (met[copy] != 0) continue;
        met[copy] = 1;
        while (result == GX_OK && gxp_next_around(body, &around))
            result = gxp_visit_cell(body, around.cell, &body->scratch.sheet_cells);
    }
    return result;
}

static gx_result gxp_judge_cells(gx_body *body) {
    const gxp_words *cells = &body->scratch.sheet_cells;
    gx_result result = GX_OK;
    uint32_t i;
    for (i = 0; i < cells->count && result == GX_OK; i++) result = gxp_judge_cell(body, cells->data[i], i + 2);
    return result;
}

/* Finds the copies that become affine by a cut: of the cells that it made or changed, and of those beside them. */
static gx_result gxp_find_sheets(gx_body *body) {
    const gxp_words *made = &body->scratch.new_cells, *changed = &body->undo.cells.rows;
    uint32_t i;
    gx_result result;
    body->scratch.bent.count = 0;
    if (!(body->config.affine_below > 0)) return GX_OK;
    result = gxp_start_sheets(body);
    for (i = 0; i < made->count && result == GX_OK; i++) result = gxp_list_near(body, made->data[i]);
    for (i = 0; i < changed->count && result == GX_OK; i++) result = gxp_list_near(body, changed->data[i]);
    return result == GX_OK ? gxp_judge_cells(body) : result;
}

/* The copies that were found become affine. Their A and its rate are 0, so nothing moves. */
static void gxp_flag_sheets(gx_body *body) {
    uint32_t i;
    for (i = 0; i < body->scratch.bent.count; i++) body->copies.affine[body->scratch.bent.data[i]] = 1;
    if (body->scratch.bent.count > 0) body->copies.bends = 1;
}

/* After other flags were read: is a copy affine? Then the model is to be made with these. */
static void gxp_find_bends(gx_body *body) {
    uint32_t i;
    body->copies.bends = 0;
    for (i = 0; i < body->copies.count && body->copies.affine != NULL; i++)
        if (body->copies.affine[i] != 0) body->copies.bends = 1;
    if (body->copies.bends) body->model.state = GXP_MODEL_STALE;
}

/* Finds and flags the thin cells of a new body. */
static gx_result gxp_first_sheets(gx_body *body) {
    uint32_t i;
    gx_result result;
    if (!(body->config.affine_below > 0)) return GX_OK;
    body->mesh.affine_length = 0;
    for (i = 0; i < body->mesh.element_count; i++) body->mesh.affine_length += gxp_element_volume(body, i);
    body->mesh.affine_length = cbrt(6 * body->mesh.affine_length / body->mesh.element_count);
    result = gxp_start_sheets(body);
    for (i = 0; i < body->cells.count && result == GX_OK; i++)
        result = gxp_visit_cell(body, i, &body->scratch.sheet_cells);
    if (result == GX_OK) result = gxp_judge_cells(body);
    if (result == GX_OK) gxp_flag_sheets(body);
    return result;
}

/* >>specks: pieces that are too small to be meant ------------------------------------------------------------------ */
/* In: the new cells of a cut, their links and volumes. Out: pairs of leaves across the cut's walls that must stay in
   one cell so that no speck comes off, and no flake, which is thinner than the tolerance; the cut is then made again.
   Touches scratch. For cuts by blades only, whose sheets are known to a tolerance: a surface of the caller is cut
   exactly. */

/* Cuts are made at most so many times. */
#define GXP_SPECK_TRIES 4

/* The cell of before the cut of which a new cell is a part */
static uint32_t gxp_cut_from(const gx_body *body, uint32_t cell) {
    while (cell >= body->undo.counts[GXP_CELLS])
        cell = gxp_cell_of_slot(body, body->slots.parent[body->cells.slot[cell]]);
    return cell;
}

static double gxp_cell_share(const gx_body *body, uint32_t cell) {
    return fabs(body->cells.data[cell].volume) / gxp_element_volume(body, body->cells.data[cell].element);
}

/* What pieces of a cut are not meant */
typedef struct gxp_not_meant {
    double share;     /* those of less, as a share of an element, summed over their elements */
    double thickness; /* m: those that are thinner between their walls, and smaller than an element */
} gxp_not_meant;

/* A piece's cells, as they are listed */
typedef struct gxp_piece {
    double share; /* of elements, summed */
    int is_thin;  /* none of its cells is too thick for a flake */
} gxp_piece;

/* No section of an element is larger than this square of its size, unless it is a sliver. */
#define GXP_SECTION 2

/* Adds a cell to a piece. */
static void gxp_add_to_piece(const gx_body *body, uint32_t cell, const gxp_not_meant *least, gxp_piece *piece) {
    const double share = gxp_cell_share(body, cell), volume = gxp_element_volume(body, body->cells.data[cell].element);
    piece->share += share;
    piece->is_thin &= piece->share < 1 && share * cbrt(volume) < GXP_SECTION * cbrt(36.0) * least->thickness;
}

/* Lists in scratch.cluster the cells that copies join to a cell, until they are more than a speck, and no flake. */
static gx_result gxp_list_cluster(gx_body *body, uint32_t start, const gxp_not_meant *least, gxp_piece *piece) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t done, j, cell;
    int k;
    gx_result result;
    scratch->cluster.count = 0;
    scratch->stamp++;
    body->cells.stamp[start] = scratch->stamp;
    result = gxp_push(body, &scratch->cluster, start);
    piece->share = 0;
    piece->is_thin = least->thickness > 0;
    for (done = 0; done < scratch->cluster.count && result == GX_OK; done++) {
        const gxp_cell *c = &body->cells.data[scratch->cluster.data[done]];
        gxp_add_to_piece(body, scratch->cluster.data[done], least, piece);
        if (!(piece->share < least->share || piece->is_thin)) break;
        for (k = 0; k < 4 && result == GX_OK; k++) {
            const uint32_t copy = c->copies[k], node = body->copies.node[copy];
            for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1] && result == GX_OK; j++) {
                const uint32_t element = body->mesh.node_elements[j];
                const int corner = gxp_local_node(body, element, node);
                for (cell = element; cell != GXP_NONE && result == GX_OK; cell = body->cells.data[cell].next) {
                    if (!body->cells.data[cell].kept || body->cells.stamp[cell] == scratch->stamp ||
                        body->cells.data[cell].copies[corner] != copy)
                        continue;
                    body->cells.stamp[cell] = scratch->stamp;
                    result = gxp_push(body, &scratch->cluster, cell);
                }
            }
        }
    }
    return result;
}

/* The area of a triangle, its corners by their coordinates in the element with these corners */
static double gxp_triangle_area(const double corners[12], const double *a, const double *b, const double *c) {
    double u[3] = {0, 0, 0}, v[3] = {0, 0, 0}, n[3];
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) {
            u[k] += (b[i] - a[i]) * corners[3 * i + k];
            v[k] += (c[i] - a[i]) * corners[3 * i + k];
        }
    gxp_cross(n, u, v);
    return 0.5 * sqrt(gxp_dot(n, n));
}

/* Adds the facets that bound a cell to the boundary, which has no triangles; without faces, those in its element's
   faces are left out. So are facets with the cell on both sides, and interfaces. */
static gx_result gxp_bound_cell(gx_body *body, uint32_t cell, int faces) {
    gxb_complex *cx = body->complex;
    uint32_t leaf, first, count, i;
    gx_result result = GX_OK;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next) {
        result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const uint32_t facet = gxp_item(cx, first + i);
            const gxb_facet *f = gxb_complex_facet(cx, facet);
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (f->face != GXB_NONE && !faces) continue;
            if (gxp_is_kept(body, other) &&
                (body->leaves.data[other].cell == cell || (f->face == GXB_NONE && !f->wall)))
                continue;
            result = gxp_add_boundary_facet(body, body->cells.data[cell].element, facet, 0);
        }
    }
    return result;
}

/* Adds the area of a cell's walls. */
static gx_result gxp_add_walls(gx_body *body, uint32_t cell, double *area) {
    const gxp_boundary *boundary = &body->scratch.boundary;
    double corners[12];
    uint32_t i;
    gx_result result;
    gxp_element_positions(body, body->cells.data[cell].element, corners);
    gxp_clear_boundary(body, 1);
    result = gxp_bound_cell(body, cell, 0);
    for (i = 0; i < boundary->triangles.count && result == GX_OK; i += 3) {
        const uint32_t *t = boundary->triangles.data + i;
        *area += gxp_triangle_area(corners, boundary->lambdas + 4 * (size_t)t[0], boundary->lambdas + 4 * (size_t)t[1],
                                   boundary->lambdas + 4 * (size_t)t[2]);
    }
    return result;
}

/* Are the cells of the cluster, which are all of a piece, a flake? */
static gx_result gxp_is_flake(gx_body *body, double thickness, int *flake) {
    const gxp_words *cluster = &body->scratch.cluster;
    double area = 0, volume = 0;
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < cluster->count && result == GX_OK; i++) {
        volume += fabs(body->cells.data[cluster->data[i]].volume);
        result = gxp_add_walls(body, cluster->data[i], &area);
    }
    *flake = volume < 0.5 * thickness * area;
    return result;
}

/* Lists in scratch.seams the leaves of a new cell of the cluster, each with one across a wall of this cut. */
static gx_result gxp_list_seams(gx_body *body, uint32_t cell) {
    gxp_scratch *scratch = &body->scratch;
    gxb_complex *cx = body->complex;
    uint32_t leaf, first, count, i;
    gx_result result = GX_OK;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next) {
        result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const gxb_facet *f = gxb_complex_facet(cx, gxp_item(cx, first + i));
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            uint32_t next;
            if (f->face != GXB_NONE || !gxp_is_kept(body, other)) continue;
            next = body->leaves.data[other].cell;
            if (body->cells.stamp[next] != scratch->stamp && gxp_cut_from(body, next) == gxp_cut_from(body, cell))
                result = gxp_push_key(body, &scratch->seams, leaf, other);
        }
    }
    return result;
}

static int gxp_share_copy(const gx_body *body, uint32_t a, uint32_t b) {
    const uint32_t *c = body->cells.data[a].copies, *d = body->cells.data[b].copies;
    int i, k, shared = a == b;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 4; k++) shared |= c[i] == d[k];
    return shared;
}

/* The cell on the far side of a seam */
static uint32_t gxp_across_seam(const gx_body *body, uint32_t seam) {
    return body->leaves.data[GXP_SECOND(body->scratch.seams.data[seam])].cell;
}

static void gxp_swap_keys(gxp_keys *keys, uint32_t i, uint32_t k) {
    const uint64_t key = keys->data[i];
    keys->data[i] = keys->data[k];
    keys->data[k] = key;
}

/* Glues the seams to the largest cell that is across one, and to those that hang together with it along the piece:
   never two sides, which would be a bridge. */
static gx_result gxp_glue_seams(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    const uint32_t count = scratch->seams.count;
    uint32_t i, done = 0, listed = 1, best = 0;
    gx_result result = GX_OK;
    for (i = 1; i < count; i++)
        if (gxp_cell_share(body, gxp_across_seam(body, i)) > gxp_cell_share(body, gxp_across_seam(body, best)))
            best = i;
    gxp_swap_keys(&scratch->seams, 0, best);
    for (; done < listed; done++) /* those that are glued come first */
        for (i = listed; i < count; i++)
            if (gxp_share_copy(body, gxp_across_seam(body, done), gxp_across_seam(body, i)))
                gxp_swap_keys(&scratch->seams, i, listed++);
    for (i = 0; i < listed && result == GX_OK; i++) {
        const uint32_t leaf = GXP_FIRST(scratch->seams.data[i]), other = GXP_SECOND(scratch->seams.data[i]);
        result = gxp_push_key(body, &scratch->glue, leaf, other);
        if (result == GX_OK) result = gxp_push_key(body, &scratch->glue, other, leaf);
    }
    return result;
}

/* Lists the leaves that hold the piece of a new cell, if it is a speck or a flake. */
static gx_result gxp_hold_piece(gx_body *body, uint32_t cell, const gxp_not_meant *least, uint32_t *found) {
    gxp_scratch *scratch = &body->scratch;
    gxp_piece piece;
    int held = 1;
    uint32_t i;
    gx_result result = gxp_list_cluster(body, cell, least, &piece);
    if (result != GX_OK) return result;
    if (!(piece.share < least->share)) held = piece.is_thin;
    if (held && !(piece.share < least->share)) result = gxp_is_flake(body, least->thickness, &held);
    scratch->seams.count = 0;
    for (i = 0; i < scratch->cluster.count && held && result == GX_OK; i++)
        result = gxp_list_seams(body, scratch->cluster.data[i]);
    if (result != GX_OK || scratch->seams.count == 0) return result;
    *found += 1;
    return gxp_glue_seams(body);
}

/* Finds the specks and flakes of a cut. *found: 0 if there are none. A piece is looked at once. */
static gx_result gxp_find_specks(gxp_cut *cut, const gxp_not_meant *least, uint32_t *found) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const uint32_t before = scratch->stamp;
    uint32_t i, n = 0;
    gx_result result = GX_OK;
    *found = 0;
    for (i = 0; i < scratch->new_cells.count && result == GX_OK; i++) {
        const uint32_t cell = scratch->new_cells.data[i];
        gxp_piece piece = {0, 1};
        gxp_add_to_piece(body, cell, least, &piece);
        if (body->cells.stamp[cell] <= before && (piece.share < least->share || piece.is_thin))
            result = gxp_hold_piece(body, cell, least, found);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, &scratch->glue, 0, scratch->glue.count);
    for (i = 0; i < scratch->glue.count; i++)
        if (i == 0 || scratch->glue.data[i] != scratch->glue.data[i - 1])
            scratch->glue.data[n++] = scratch->glue.data[i];
    scratch->glue.count = n;
    return result;
}

/* >>settle: giving back what removed material has held ------------------------------------------------------------- */
/* In: a cut that has been made. Out: once it is committed, the same body after gxb_complex_compact. All memory is taken
   before; without it the cut fails. Touches rows of leaves and cells, indices of planes, maps. */

static uint32_t *gxp_vertex_bucket(gxp_skin *s, const gxp_skin_key *key) {
    uint64_t h = gxp_mix((uint64_t)key->group[0] << 32 | key->group[1]) + key->point;
    h = gxp_mix(h ^ ((uint64_t)key->name[0] << 32 | key->name[1]));
    h = gxp_mix(h ^ ((uint64_t)key->name[2] << 32 | key->name[3]));
    return &s->vertex_buckets.data[h & (s->vertex_buckets.count - 1)];
}

/* Rows of leaves that went go, others get their new places. Of those of a cell that became one, the first stays. */
static void gxp_settle_leaves(gx_body *body, const gxb_renumbering *r) {
    gxp_leaf *data = body->leaves.data;
    uint32_t cell, leaf, next;
    for (cell = 0; cell < body->cells.count; cell++) {
        uint32_t *link = &body->cells.data[cell].first_leaf;
        for (leaf = *link; leaf != GXP_NONE; leaf = next) {
            next = data[leaf].next;
            if (r->leaf_of[leaf] != leaf) continue;
            *link = r->leaves[leaf];
            link = &data[leaf].next;
        }
        *link = GXP_NONE;
    }
    for (leaf = next = 0; leaf < r->leaf_count; leaf++)
        if (r->leaf_of[leaf] == leaf) gxp_copy_row(body, GXP_LEAVES, leaf, next++);
    body->leaves.count = next;
}

/* Keys of the skin's vertices name planes. Those of planes that went are of no use: their elements will be drawn anew.
   There is room to note which. */
static void gxp_settle_skin(gx_body *body, const gxb_renumbering *r) {
    gxp_skin *s = &body->skin;
    uint32_t i;
    if (!s->made || r->renamed) {
        s->made = 0;
        return;
    }
    for (i = 0; i < body->mesh.element_count; i++)
        if (r->changed[i]) s->dirty.data[s->dirty.count++] = i;
    if (s->vertex_buckets.count > 0)
        memset(s->vertex_buckets.data, 0xff, s->vertex_buckets.count * sizeof *s->vertex_buckets.data);
    for (i = 0; i < s->vertex_count; i++) {
        gxp_skin_key *key = &s->vertices[i].key;
        uint32_t *bucket;
        if (key->group[1] >= GXP_PLANE_GROUP && key->group[1] != GXP_NONE) {
            const uint32_t plane = r->planes[(key->group[1] - GXP_PLANE_GROUP) >> 1], side = key->group[1] & 1;
            key->group[1] = plane == GXB_NONE ? GXP_NONE : GXP_PLANE_GROUP + 2 * plane + side;
        }
        bucket = gxp_vertex_bucket(s, key);
        s->vertices[i].next = *bucket;
        *bucket = i;
    }
}

/* Rows of removed cells go, but for the elements' first ones. place: by row, for their new places */
static void gxp_settle_cells(gx_body *body, uint32_t *place) {
    gxp_cell *data = body->cells.data;
    uint32_t i, n = 0;
    for (i = 0; i < body->cells.count; i++) place[i] = i < body->mesh.element_count || data[i].kept ? n++ : GXP_NONE;
    for (i = 0; i < body->leaves.count; i++) { /* a hollow leaf may have been in a cell that goes */
        const uint32_t cell = body->leaves.data[i].cell;
        body->leaves.data[i].cell = place[cell] == GXP_NONE ? data[cell].element : place[cell];
    }
    for (i = 0; i < body->skin.triangle_count; i++) {
        const uint32_t cell = body->skin.cell[i];
        body->skin.cell[i] = place[cell] == GXP_NONE ? data[cell].element : place[cell];
    }
    for (i = 0; i < body->cells.count; i++)
        while (data[i].next != GXP_NONE && place[data[i].next] == GXP_NONE) data[i].next = data[data[i].next].next;
    for (i = 0; i < body->cells.count; i++) {
        if (place[i] == GXP_NONE) continue;
        if (data[i].next != GXP_NONE) data[i].next = place[data[i].next];
        gxp_copy_row(body, GXP_CELLS, i, place[i]);
    }
    body->cells.count = n;
    body->scratch.new_cells.count = 0;
}

/* The surface of a cut triangle */
static uint32_t gxp_label_surface(const gx_body *body, uint32_t label) {
    uint32_t low = 0, high = body->cuts.surface_count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (body->cuts.surfaces[middle].label <= label)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Maps of surfaces that show nowhere any more go. shown: a byte for each surface */
static void gxp_settle_maps(gx_body *body, unsigned char *shown) {
    gxp_cuts *cuts = &body->cuts;
    uint32_t i, n = 0;
    if (cuts->map_count == 0) return;
    memset(shown, 0, cuts->surface_count);
    for (i = 0; i < gxb_complex_label_count(body->complex); i++)
        shown[gxp_label_surface(body, gxb_complex_label(body->complex, i)->triangle)] = 1;
    for (i = 0; i < cuts->surface_count; i++) {
        gxp_surface_record *r = &cuts->surfaces[i];
        const uint32_t end = i + 1 < cuts->surface_count ? r[1].label : cuts->label_count, count = end - r->label;
        if (r->map == GXP_NONE) continue;
        if (shown[i]) {
            memmove(cuts->maps + 8 * (size_t)n, cuts->maps + 8 * (size_t)r->map, 8 * count * sizeof *cuts->maps);
            r->map = n;
            n += count;
        } else
            r->map = GXP_NONE;
    }
    cuts->map_count = n;
}

/* A compaction to come, planned while the cut can still be taken back */
typedef struct gxp_settling {
    gxb_renumbering renumbering;
    uint32_t *place; /* NULL: there will be none */
    size_t size;
} gxp_settling;

/* Surveys the complex. Interfaces stay: leaves of different cells are not united. */
static gx_result gxp_survey(gx_body *body, gxb_renumbering *r) {
    const size_t size = body->leaves.count * sizeof(uint32_t);
    uint32_t *cells = NULL, i;
    gx_result result;
    if (gxp_is_mixed(body)) {
        cells = (uint32_t *)gxp_allocate(&body->config.allocator, size);
        if (cells == NULL) return GX_ERROR_MEMORY;
        for (i = 0; i < body->leaves.count; i++) cells[i] = body->leaves.data[i].cell;
    }
    result = gxb_complex_survey(body->complex, body->mesh.node_pinched, cells, r);
    gxp_release(&body->config.allocator, cells, size);
    return result;
}

/* Plans a compaction, once a body has cost enough since the last one. What is beyond the limits stays as it is. */
static gx_result gxp_plan_settling(gx_body *body, gxp_settling *s) {
    gx_result result = GX_OK;
    memset(s, 0, sizeof *s);
    if (!gxb_complex_is_sparse(body->complex)) return GX_OK;
    if (body->skin.made) result = gxp_words_room(body, &body->skin.dirty, body->mesh.element_count);
    if (result == GX_OK) result = gxp_survey(body, &s->renumbering);
    if (result != GX_OK) return result == GX_ERROR_LIMIT ? GX_OK : result;
    s->size = body->cells.count * sizeof(uint32_t) + body->cuts.surface_count;
    s->place = (uint32_t *)gxp_allocate(&body->config.allocator, s->size);
    if (s->place != NULL) return GX_OK;
    gxb_complex_forget(body->complex, &s->renumbering);
    return GX_ERROR_MEMORY;
}

/* Carries it out. The order of all items stays, so that nothing else changes. */
static void gxp_settle(gx_body *body, gxp_settling *s) {
    if (s->place == NULL) return;
    gxb_complex_compact(body->complex, &s->renumbering);
    gxp_settle_leaves(body, &s->renumbering);
    gxp_settle_skin(body, &s->renumbering);
    gxb_complex_forget(body->complex, &s->renumbering);
    gxp_settle_maps(body, (unsigned char *)(s->place + body->cells.count));
    gxp_settle_cells(body, s->place);
    body->scratch.boundary.points.count = 0;
    gxp_release(&body->config.allocator, s->place, s->size);
}

/* >>cut: the driver ------------------------------------------------------------------------------------------------ */
/* gx_body_cut: check, begin, arrange, enrich, integrate, then commit, or roll back on any error. The commit cannot
   fail. It drops dead copies, wakes the touched copies and marks model, skin, view and snapshot as stale. */

static uint64_t gxp_hash_cut(uint64_t past, const gxp_cut *cut) {
    const gx_cut_desc *desc = cut->desc;
    size_t i;
    past = gxp_hash_words(past, desc->scope_fragments, desc->scope_fragment_count);
    past = gxp_hash_doubles(gxp_hash_words(past, desc->scope_cells, desc->scope_cell_count), &desc->sever_below, 1);
    for (i = 0; i < desc->surface_count; i++) {
        const gx_surface *s = &desc->surfaces[i];
        past = gxp_hash_doubles(gxp_mix(past ^ s->kind ^ (uint64_t)s->vertex_count << 8), s->vertices,
                                3 * s->vertex_count);
        past = gxp_hash_texture(gxp_hash_words(past, s->triangles, 3 * s->triangle_count), s->texture, s->vertex_count);
        if (s->scope_slots != NULL) past = gxp_hash_words(gxp_mix(past), s->scope_slots, s->scope_slot_count);
        if (gxp_is_mixed(cut->body) && (cut->shapes || s->kind == GX_SURFACE_MATERIAL))
            past = gxp_mix(past ^ s->material);
    }
    return desc->release_count > 0 ? gxp_hash_words(gxp_mix(past), desc->release, 2 * desc->release_count) : past;
}

static gx_result gxp_check_release(const gx_body *body, const gx_cut_desc *desc, gx_failure *failure) {
    size_t i;
    if (desc->release_count > 0 && desc->release == NULL) return gxp_refuse(failure, "release");
    if (desc->release_count > SIZE_MAX / 2) return gxp_fail(failure, GX_ERROR_LIMIT, "release_count", SIZE_MAX);
    for (i = 0; i < 2 * desc->release_count; i++)
        if (desc->release[i] != GX_ANY_MATERIAL && desc->release[i] >= body->mesh.material_count)
            return gxp_fail(failure, GX_ERROR_INDEX, "release", i / 2);
    return GX_OK;
}

static gx_result gxp_check_cut(gxp_cut *cut) {
    const gx_cut_desc *desc = cut->desc;
    gx_failure *failure = &cut->failure;
    size_t i;
    gx_result result = gxp_check_release(cut->body, desc, failure);
    if (result != GX_OK) return result;
    if (desc->surfaces == NULL && (desc->surface_count > 0 || desc->release_count == 0))
        return gxp_refuse(failure, "surfaces");
    if (desc->scope_fragment_count > 0 && desc->scope_fragments == NULL) return gxp_refuse(failure, "scope_fragments");
    if (desc->scope_cell_count > 0 && desc->scope_cells == NULL) return gxp_refuse(failure, "scope_cells");
    if (desc->surface_count == 0 && desc->release_count == 0)
        return gxp_fail(failure, GX_ERROR_EMPTY, "surface_count", SIZE_MAX);
    if (!gxp_is_finite(desc->sever_below)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "sever_below", SIZE_MAX);
    if (desc->sever_below < 0 || desc->sever_below > 1) return gxp_refuse(failure, "sever_below");
    for (i = 0; i < desc->surface_count && result == GX_OK; i++) {
        result = gxp_check_surface(cut->body, &desc->surfaces[i], failure);
        if (result != GX_OK) failure->surface = i;
    }
    return result;
}

/* Removes the leaves that the solids contain. Touches their cells and those around. */
static gx_result gxp_remove_leaves(gx_body *body) {
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gx_result result = gxp_words_room(body, &scratch->touched, scratch->removed.count);
    gxp_sort_unique(&scratch->removed);
    for (i = 0; i < scratch->removed.count && result == GX_OK; i++) {
        result = gxb_complex_set_removed(body->complex, scratch->removed.data[i]);
        if (result == GX_OK)
            result = gxp_push(body, &scratch->touched, body->leaves.data[scratch->removed.data[i]].cell);
    }
    for (i = 0; i < scratch->removed.count && result == GX_OK; i++)
        result = gxp_touch_around(body, scratch->removed.data[i]);
    return result;
}

/* Inserts all surfaces, then finds the leaves inside the solids. */
static gx_result gxp_arrange_surfaces(gxp_cut *cut, gxp_surface *surfaces) {
    const size_t count = cut->desc->surface_count;
    size_t i;
    int scoped;
    gx_result result = gxp_stamp_scope(cut);
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxp_stamp_surface(cut, &cut->desc->surfaces[i], &scoped);
        if (result == GX_OK) result = gxp_surface_open(cut, &surfaces[i], &cut->desc->surfaces[i], i);
        if (result == GX_OK) result = gxp_insert_surface(cut, &surfaces[i], scoped);
    }
    if (result == GX_OK) result = gxp_follow_leaves(cut->body);
    if (cut->shapes && result == GX_OK) return gxp_find_shape(cut, surfaces);
    for (i = 0; i < count && result == GX_OK; i++)
        if (surfaces[i].given->kind != GX_SURFACE_SHEET) result = gxp_find_solid(cut, &surfaces[i]);
    return result;
}

/* From surfaces to leaves: the complex has all walls, removed leaves are marked, cells beside them touched. */
static gx_result gxp_arrange(gxp_cut *cut) {
    gx_body *body = cut->body;
    const size_t count = cut->desc->surface_count;
    gxp_surface *surfaces = NULL;
    gx_result result;
    size_t i;
    if (count > 0) {
        surfaces = (gxp_surface *)gxp_allocate(&body->config.allocator, count * sizeof *surfaces);
        if (surfaces == NULL) return GX_ERROR_MEMORY;
        memset(surfaces, 0, count * sizeof *surfaces);
    }
    body->scratch.touched.count = body->scratch.removed.count = body->scratch.pinches.count = 0;
    body->scratch.given_to.count = body->scratch.remade.count = 0;
    result = gxp_arrange_surfaces(cut, surfaces);
    for (i = 0; i < count; i++)
        if (surfaces[i].given != NULL) gxp_surface_free(body, &surfaces[i]);
    gxp_release(&body->config.allocator, surfaces, count * sizeof *surfaces);
    if (result == GX_OK) result = gxp_list_new_leaves(cut);
    if (result == GX_OK) result = gxp_remove_leaves(body);
    if (result == GX_OK && body->scratch.given_to.count > 0) result = gxp_give_materials(cut);
    return result == GX_OK && cut->desc->release_count > 0 ? gxp_release_materials(cut) : result;
}

/* From leaves to copies: touched cells fall apart, small links are severed, nodes get copies. */
static gx_result gxp_enrich(gxp_cut *cut) {
    gx_result result = gxp_collect_touched(cut);
    if (result == GX_OK) result = gxp_divide_cells(cut);
    if (result == GX_OK && cut->desc->sever_below > 0) result = gxp_sever_links(cut);
    if (result == GX_OK && cut->report.severed_links > 0) result = gxp_touch_severed(cut);
    return result == GX_OK ? gxp_divide_nodes(cut) : result;
}

/* Integrates a new cell and all other new cells of its element; only the cell if the element has many. *before: the
   element of the new cell before it. */
static gx_result gxp_integrate_new(gx_body *body, uint32_t cell, uint32_t *before) {
    const uint32_t element = body->cells.data[cell].element;
    if (body->cells.stamp[element] == body->scratch.stamp) return GX_OK;
    gxp_clear_boundary(body, element != *before);
    *before = element;
    if (!gxp_has_few_cells(body, element)) return gxp_integrate_cell(body, cell, gxp_element_volume(body, element));
    body->cells.stamp[element] = body->scratch.stamp;
    return gxp_integrate_element(body, element);
}

/* Prefetches the data that weighing the links of the next new cells will read: facets three cells ahead, their loops
   two ahead, the edges of the next. */
GXP_PREFETCHES void gxp_prefetch_links(const gx_body *body, uint32_t index) {
    const gxp_scratch *scratch = &body->scratch;
    const gxb_complex *cx = body->complex;
    const uint32_t *first = scratch->link_first.data;
    const uint32_t count = scratch->new_cells.count;
    uint32_t j, i;
    if (index + 3 < count)
        for (j = first[index + 3]; j < first[index + 4]; j++)
            GXP_PREFETCH(gxb_complex_facet(cx, GXP_LINK_FACET(scratch->links.data[j])));
    if (index + 2 < count)
        for (j = first[index + 2]; j < first[index + 3]; j++) {
            const gxb_facet *f = gxb_complex_facet(cx, GXP_LINK_FACET(scratch->links.data[j]));
            GXP_PREFETCH(gxb_complex_list(cx, f->loop));
            GXP_PREFETCH(&gxb_complex_plane(cx, f->plane)->axis);
        }
    if (index + 1 < count)
        for (j = first[index + 1]; j < first[index + 2]; j++) {
            const gxb_facet *f = gxb_complex_facet(cx, GXP_LINK_FACET(scratch->links.data[j]));
            for (i = 0; i < f->loop_count; i++) GXP_PREFETCH(gxb_complex_edge(cx, gxp_item(cx, f->loop + i) >> 1));
        }
}

/* Integrates the new cells. Unless links were weighed before to be severed, weighs them here, while their facets are in
   the cache. */
static gx_result gxp_integrate(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const int weighed = cut->desc->sever_below > 0;
    double bound = 1;
    uint32_t i, before = GXP_NONE;
    gx_result result = gxp_integrate_removed(cut);
    scratch->narrow.count = 0;
    scratch->stamp++;
    for (i = 0; i < scratch->new_cells.count && result == GX_OK; i++) {
        gxp_prefetch_links(body, i);
        if (!weighed) result = gxp_weigh_links(cut, i, &bound);
        if (result == GX_OK) result = gxp_integrate_new(body, scratch->new_cells.data[i], &before);
    }
    return result == GX_OK ? gxp_judge_links(cut, bound) : result;
}

static gx_result gxp_push_leaf_elements(gx_body *body, uint32_t facet) {
    const gxb_complex *cx = body->complex;
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < 2 && result == GX_OK; i++)
        if (gxb_complex_facet(cx, facet)->leaf[i] != GXB_NONE)
            result =
                gxp_push(body, &body->skin.dirty, gxb_complex_leaf(cx, gxb_complex_facet(cx, facet)->leaf[i])->element);
    return result;
}

/* Notes for the skin the elements in which the cut made facets or walls or changed a cell, and those whose copies get
   new numbers when dead ones are dropped. An element noted in vain does no harm. */
static gx_result gxp_note_for_skin(gxp_cut *cut, uint32_t first_facet) {
    gx_body *body = cut->body;
    gxp_scratch *scratch = &body->scratch;
    const gxb_complex *cx = body->complex;
    uint32_t i, j;
    gx_result result = GX_OK;
    if (!body->skin.made) return GX_OK;
    if (body->skin.dirty.count / 8 > body->mesh.element_count) {
        body->skin.made = 0;
        return GX_OK;
    }
    for (i = first_facet; i < gxb_complex_facet_count(cx) && result == GX_OK; i++)
        result = gxp_push_leaf_elements(body, i);
    for (i = 0; i < gxb_complex_marked_count(cx) && result == GX_OK; i++)
        result = gxp_push_leaf_elements(body, gxb_complex_marked_facet(cx, i));
    for (i = 0; i < body->undo.cells.rows.count && result == GX_OK; i++)
        result = gxp_push(body, &body->skin.dirty, body->cells.data[body->undo.cells.rows.data[i]].element);
    for (i = 0; i < scratch->pinches.count; i++) /* edges may be divided there without a new facet */
        for (j = body->mesh.node_start[scratch->pinches.data[i]];
             j < body->mesh.node_start[scratch->pinches.data[i] + 1] && result == GX_OK; j++)
            result = gxp_push(body, &body->skin.dirty, body->mesh.node_elements[j]);
    for (i = body->copies.count - scratch->dead.count; i < body->copies.count; i++) {
        const uint32_t node = body->copies.node[i];
        for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1] && result == GX_OK; j++)
            result = gxp_push(body, &body->skin.dirty, body->mesh.node_elements[j]);
    }
    return result;
}

/* Puts the last copy in the place of a dead one. */
static void gxp_drop_copy(gx_body *body, uint32_t copy) {
    const uint32_t last = --body->copies.count, node = body->copies.node[last];
    uint32_t j, cell;
    if (copy == last) return;
    for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1]; j++) {
        const uint32_t element = body->mesh.node_elements[j];
        const int k = gxp_local_node(body, element, node);
        for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next)
            if (body->cells.data[cell].copies[k] == last) body->cells.data[cell].copies[k] = copy;
    }
    gxp_copy_row(body, GXP_COPIES, last, copy);
}

/* Wakes the copies of a touched cell and marks their fragment as touched. */
static void gxp_touch_copies(gx_body *body, const gxp_cell *cell) {
    int k;
    for (k = 0; k < 4; k++) {
        body->copies.rest_time[cell->copies[k]] = 0;
        body->copies.label[cell->copies[k]] |= 1;
    }
}

/* Notes the elements of the model that have changed. Without memory for that, the model is made whole; so it is where
   the body was saved, loaded, cloned or restored since its last step, so that both bodies then have the same model. */
static void gxp_note_changed(gx_body *body) {
    const gxp_words *changed = &body->undo.cells.rows, *made = &body->scratch.new_cells;
    gx_result result = GX_OK;
    uint32_t i;
    if (body->model.resumed != 0) body->model.state = GXP_MODEL_STALE;
    if (body->model.state == GXP_MODEL_STALE) return;
    for (i = 0; i < changed->count && result == GX_OK; i++)
        result = gxp_push(body, &body->model.changed, body->cells.data[changed->data[i]].element);
    for (i = 0; i < made->count && result == GX_OK; i++)
        result = gxp_push(body, &body->model.changed, body->cells.data[made->data[i]].element);
    body->model.state = result == GX_OK ? GXP_MODEL_CHANGED : GXP_MODEL_STALE;
}

static void gxp_commit(gxp_cut *cut) {
    gx_body *body = cut->body;
    gxp_view *view = &body->view;
    gxp_scratch *scratch = &body->scratch;
    uint32_t i;
    gxp_flag_sheets(body);
    gxp_note_changed(body);
    for (i = 0; i < scratch->new_cells.count; i++)
        gxp_touch_copies(body, &body->cells.data[scratch->new_cells.data[i]]);
    for (i = 0; i < scratch->remade.count; i++) gxp_touch_copies(body, &body->cells.data[scratch->remade.data[i]]);
    for (i = 0; i < scratch->touched.count; i++) {
        gxp_cell *cell = &body->cells.data[scratch->touched.data[i]];
        if (cell->kept) continue;
        gxp_touch_copies(body, cell); /* also cells that it held by an edge or node only */
        memset(cell->copies, 0xff, sizeof cell->copies);
    }
    for (i = 0; i < scratch->removed.count; i++) body->leaves.data[scratch->removed.data[i]].next = GXP_NONE;
    cut->report.removed_copies = scratch->dead.count;
    gxp_sort_unique(&scratch->dead);
    for (i = scratch->dead.count; i-- > 0;) gxp_drop_copy(body, scratch->dead.data[i]);
    gxb_complex_commit(body->complex);
    body->undo.cells.rows.count = body->undo.leaves.rows.count = 0;
    body->cuts.hash = gxp_hash_cut(body->cuts.hash, cut);
    if (cut->report.created_copies + cut->report.removed_copies > 0)
        body->cuts.epoch = body->cuts.hash != 0 ? body->cuts.hash : 1;
    body->holds.stale = view->stale = 1;
    body->snapshot.stale = 1;
    if (scratch->removed.count + scratch->dead.count > 0 || view->splits.count > body->copies.count)
        view->labels_known = 0;
    if (!view->labels_known) view->splits.count = 0;
}

static gx_result gxp_tell_failure(gxp_cut *cut, gx_result result, gx_failure *failure) {
    gxp_close(&cut->failure, result);
    if (failure != NULL) *failure = cut->failure;
    return result;
}

/* From surfaces to integrals. Nothing is final yet. */
static gx_result gxp_make_cut(gxp_cut *cut) {
    gx_body *body = cut->body;
    gx_cut_report *report = &cut->report;
    uint32_t first_facet;
    double start;
    gx_result result;
    memset(report, 0, sizeof *report);
    report->min_link_ratio = 1;
    gxp_begin(cut);
    first_facet = gxb_complex_facet_count(body->complex);
    start = gxp_seconds(body);
    result = gxp_arrange(cut);
    report->seconds_arrangement = gxp_seconds(body) - start;
    if (result == GX_OK) result = gxp_enrich(cut);
    report->seconds_enrichment = gxp_seconds(body) - start - report->seconds_arrangement;
    if (result == GX_OK) result = gxp_integrate(cut);
    report->seconds_integrals = gxp_seconds(body) - start - report->seconds_arrangement - report->seconds_enrichment;
    if (result == GX_OK) result = gxp_find_sheets(body);
    return result == GX_OK ? gxp_note_for_skin(cut, first_facet) : result;
}

/* least: which pieces stay with the material beside them; NULL: none does */
static gx_result gxp_run_cut(gxp_cut *cut, const gxp_not_meant *least, gx_failure *failure) {
    gx_body *body = cut->body;
    gxp_settling settling;
    uint32_t found = 0, tries;
    gx_result result;
    gxp_end(&cut->failure, GX_OK);
    result = gxp_check_cut(cut);
    if (result != GX_OK) return gxp_tell_failure(cut, result, failure);
    body->scratch.glue.count = 0;
    for (tries = 1;; tries++) {
        result = gxp_make_cut(cut);
        if (result == GX_OK && least != NULL && tries < GXP_SPECK_TRIES) result = gxp_find_specks(cut, least, &found);
        if (result != GX_OK || found == 0 || tries == GXP_SPECK_TRIES) break;
        gxp_rollback(cut);
    }
    body->scratch.glue.count = 0;
    if (result == GX_OK) result = gxp_plan_settling(body, &settling);
    if (result != GX_OK) {
        gxp_rollback(cut);
        return gxp_tell_failure(cut, result, failure);
    }
    gxp_wake_resumed(body, body->undo.counts[GXP_COPIES]);
    gxp_commit(cut);
    gxp_settle(body, &settling);
    if (body->model.resumed != 0) body->model.resumed = gxp_hash_state(body, body->copies.count);
    return gxp_end(failure, GX_OK);
}

static gx_result gxp_cut_body(gx_body *body, const gx_cut_desc *desc, const gxp_not_meant *least, gx_cut_report *report,
                              gx_failure *failure) {
    gxp_cut cut;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (desc == NULL) return gxp_refuse(failure, "desc");
    memset(&cut, 0, sizeof cut);
    cut.body = body;
    cut.desc = desc;
    result = gxp_run_cut(&cut, least, failure);
    if (result == GX_OK && report != NULL) *report = cut.report;
    return result;
}

GXFEM_API gx_result gx_body_cut(gx_body *body, const gx_cut_desc *desc, gx_cut_report *report, gx_failure *failure) {
    return gxp_cut_body(body, desc, NULL, report, failure);
}

/* >>solidify: a sheet made solid ----------------------------------------------------------------------------------- */
/* In: a sheet and a thickness. Out: the closed surface between its two offsets (GXFEM section 4.1). Knows no body. */

/* Sums the area normals around each vertex of the sheet and scales each sum to half the thickness. Edges are measured
   in units of the longest one's power of two, so that areas stay in range. */
static void gxp_offset_vectors(const gx_surface *s, double half, double *normals) {
    double longest = 0;
    size_t i;
    int k, c, pass, exponent = 0;
    memset(normals, 0, 3 * s->vertex_count * sizeof *normals);
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < s->triangle_count; i++) {
            const uint32_t *t = s->triangles + 3 * i;
            double e[2][3], n[3];
            for (c = 0; c < 2; c++)
                for (k = 0; k < 3; k++) {
                    e[c][k] = s->vertices[3 * (size_t)t[c + 1] + (size_t)k] - s->vertices[3 * (size_t)t[0] + (size_t)k];
                    if (pass == 0 && fabs(e[c][k]) > longest) longest = fabs(e[c][k]);
                    e[c][k] = ldexp(e[c][k], -exponent);
                }
            for (k = 0; k < 3; k++)
                n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
            for (c = 0; c < 3 && pass == 1; c++)
                for (k = 0; k < 3; k++) normals[3 * (size_t)t[c] + (size_t)k] += n[k];
        }
        if (gxp_is_finite(longest)) (void)frexp(longest, &exponent);
    }
    for (i = 0; i < s->vertex_count; i++) {
        double *n = normals + 3 * i;
        if (gxp_unit(n, n))
            for (k = 0; k < 3; k++) n[k] *= half;
    }
}

/* Closes the rim: appends a quad for each half-edge whose edge has more triangles one way than the other. */
static gx_result gxp_close_solid(const gx_surface *s, const gx_allocator *a, uint32_t *triangles, size_t *count) {
    const size_t n = 3 * s->triangle_count, size = n * sizeof(gxp_half_edge);
    const uint32_t v = (uint32_t)s->vertex_count;
    gxp_half_edge *edges = (gxp_half_edge *)gxp_allocate(a, size);
    size_t i, j, k;
    if (edges == NULL) return GX_ERROR_MEMORY;
    for (i = 0; i < n; i++) {
        edges[i].from = s->triangles[i];
        edges[i].to = s->triangles[i % 3 == 2 ? i - 2 : i + 1];
        edges[i].triangle = (uint32_t)(i / 3);
        edges[i].corner = (uint32_t)(i % 3);
    }
    qsort(edges, n, sizeof *edges, gxp_compare_half_edges);
    for (i = 0; i < n; i = j) {
        long balance = 0;
        for (j = i; j < n && gxp_same_ends(&edges[i], &edges[j]); j++) balance += edges[j].from < edges[j].to ? 1 : -1;
        for (k = i; k < j && balance != 0; k++) {
            const uint32_t from = edges[k].from, to = edges[k].to;
            const long way = from < to ? 1 : -1;
            uint32_t *t = triangles + 3 * *count;
            if (way * balance < 0) continue;
            balance -= way;
            t[0] = to;
            t[1] = from;
            t[2] = from + v;
            t[3] = to;
            t[4] = from + v;
            t[5] = to + v;
            *count += 2;
        }
    }
    gxp_release(a, edges, size);
    return GX_OK;
}

static gx_result gxp_check_sheet(const gx_surface *s, gx_failure *failure) {
    size_t i;
    if (s->vertex_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "vertex_count", SIZE_MAX);
    if (s->triangle_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "triangle_count", SIZE_MAX);
    if (s->vertices == NULL) return gxp_refuse(failure, "vertices");
    if (s->triangles == NULL) return gxp_refuse(failure, "triangles");
    if (s->vertex_count > INT32_MAX / 2) return gxp_fail(failure, GX_ERROR_LIMIT, "vertex_count", SIZE_MAX);
    if (s->triangle_count > INT32_MAX / 8) return gxp_fail(failure, GX_ERROR_LIMIT, "triangle_count", SIZE_MAX);
    for (i = 0; i < 3 * s->vertex_count; i++)
        if (!gxp_is_finite(s->vertices[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "vertices", i / 3);
    for (i = 0; i < 3 * s->triangle_count; i++)
        if (s->triangles[i] >= s->vertex_count) return gxp_fail(failure, GX_ERROR_INDEX, "triangles", i / 3);
    return GX_OK;
}

GXFEM_API gx_result gx_surface_solidify(const gx_surface *sheet, double thickness, double *solid_vertices,
                                        size_t *solid_vertex_count, uint32_t *solid_triangles,
                                        size_t *solid_triangle_count, const gx_allocator *allocator,
                                        gx_failure *failure) {
    gx_allocator none;
    size_t i, count;
    gx_result result;
    double *normals;
    memset(&none, 0, sizeof none);
    if (allocator == NULL) allocator = &none;
    if (sheet == NULL) return gxp_refuse(failure, "sheet");
    if (solid_vertices == NULL) return gxp_refuse(failure, "solid_vertices");
    if (solid_vertex_count == NULL) return gxp_refuse(failure, "solid_vertex_count");
    if (solid_triangles == NULL) return gxp_refuse(failure, "solid_triangles");
    if (solid_triangle_count == NULL) return gxp_refuse(failure, "solid_triangle_count");
    if (!gxb_is_allocator(allocator)) return gxp_refuse(failure, "allocator");
    if (!gxp_is_finite(thickness)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "thickness", SIZE_MAX);
    if (!(thickness > 0)) return gxp_refuse(failure, "thickness");
    result = gxp_check_sheet(sheet, failure);
    if (result != GX_OK) return result;
    normals = (double *)gxp_allocate(allocator, 3 * sheet->vertex_count * sizeof *normals);
    if (normals == NULL) return gxp_end(failure, GX_ERROR_MEMORY);
    gxp_end(failure, GX_OK);
    gxp_offset_vectors(sheet, 0.5 * thickness, normals);
    count = 2 * sheet->triangle_count;
    result = gxp_close_solid(sheet, allocator, solid_triangles, &count);
    for (i = 0; i < 3 * sheet->vertex_count && result == GX_OK; i++) {
        double *above = &solid_vertices[i], *below = &solid_vertices[3 * sheet->vertex_count + i];
        *above = sheet->vertices[i] + normals[i];
        *below = sheet->vertices[i] - normals[i];
        if (!gxp_is_finite(*above) || !gxp_is_finite(*below))
            result = gxp_fail(failure, GX_ERROR_RANGE, "vertices", i / 3);
    }
    for (i = 0; i < 3 * sheet->triangle_count && result == GX_OK; i++) {
        solid_triangles[i] = sheet->triangles[i];
        solid_triangles[3 * sheet->triangle_count + i] =
            sheet->triangles[i - i % 3 + (3 - i % 3) % 3] + (uint32_t)sheet->vertex_count;
    }
    gxp_release(allocator, normals, 3 * sheet->vertex_count * sizeof *normals);
    if (result != GX_OK) return gxp_close(failure, result);
    *solid_vertex_count = 2 * sheet->vertex_count;
    *solid_triangle_count = count;
    return GX_OK;
}

/* >>anchors: material points that survive cuts --------------------------------------------------------------------- */
/* In: a material point in an element, and another one towards which it holds its side. Out: the leaf and the cell that
   have it now, exactly; anchors made such that they lie in a given part. Changes nothing but the complex's exact
   numbers and lists. */

/* The leaf that has a material point, kept or removed: see gxb_complex_leaf_at. toward: or NULL */
static gx_result gxp_leaf_at(gx_body *body, uint32_t element, const double position[3], const double toward[3],
                             uint32_t *leaf) {
    gx_result result = gxb_complex_check_point(body->complex, position);
    if (result == GX_OK && toward != NULL) result = gxb_complex_check_point(body->complex, toward);
    if (result == GX_OK) *leaf = gxb_complex_leaf_at(body->complex, element, position, toward, NULL);
    return result;
}

/* The least side on which the point lies of the element's faces, exactly: 1 inside the element, 0 on its boundary, -1
   outside */
static int gxp_element_side(const gx_body *body, uint32_t element, const double x[3]) {
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    const double *p = body->mesh.positions;
    int least = 1, k;
    for (k = 0; k < 4 && least >= 0; k++) {
        const uint8_t *face = gxp_outward[k];
        const int side =
            gxb_orient3d(p + 3 * (size_t)n[face[0]], p + 3 * (size_t)n[face[1]], p + 3 * (size_t)n[face[2]], x);
        if (side < least) least = side;
    }
    return least;
}

/* names: of the anchor's element, position, toward */
static gx_result gxp_check_anchor(const gx_body *body, const gx_anchor *anchor, const char *const names[3],
                                  size_t index, gx_failure *failure) {
    gx_result result;
    if (anchor->element >= body->mesh.element_count) return gxp_fail(failure, GX_ERROR_INDEX, names[0], index);
    result = gxb_complex_check_point(body->complex, anchor->position);
    if (result != GX_OK) return gxp_fail(failure, result, names[1], index);
    result = gxb_complex_check_point(body->complex, anchor->toward);
    if (result != GX_OK) return gxp_fail(failure, result, names[2], index);
    return gxp_element_side(body, anchor->element, anchor->position) >= 0
             ? GX_OK
             : gxp_fail(failure, GX_ERROR_ARGUMENT, names[1], index);
}

/* The cell that has the material of an anchor, which was checked; GXP_NONE: it is gone */
static uint32_t gxp_anchor_cell(gx_body *body, const gx_anchor *anchor) {
    const uint32_t leaf = gxb_complex_leaf_at(body->complex, anchor->element, anchor->position, anchor->toward, NULL);
    return gxp_is_kept(body, leaf) ? body->leaves.data[leaf].cell : GXP_NONE;
}

/* det(b - a, c - a, d - a) of x = a b c d, exact */
static GXP_COLD void gxp_exact_determinant(const double *const x[4], gxb_num *r) {
    gxb_limb limbs[9][GXB_NUM_LIMBS / 4]; /* differences of doubles have a fifth of the longest number's bits */
    gxb_num e[9];
    int i, k;
    GXB_NUM(p);
    GXB_NUM(q);
    GXB_NUM(minor);
    GXB_NUM(term);
    GXB_NUM(sum);
    for (i = 0; i < 9; i++) {
        memset(&e[i], 0, sizeof e[i]);
        e[i].d = limbs[i];
        gxb_num_set(&p, x[1 + i / 3][i % 3], 0);
        gxb_num_set(&q, x[0][i % 3], 0);
        gxb_num_sub(&e[i], &p, &q);
    }
    gxb_num_set(r, 0, 0);
    for (k = 0; k < 3; k++) {
        gxb_num_mul(&p, &e[3 + (k + 1) % 3], &e[6 + (k + 2) % 3]);
        gxb_num_mul(&q, &e[3 + (k + 2) % 3], &e[6 + (k + 1) % 3]);
        gxb_num_sub(&minor, &p, &q);
        gxb_num_mul(&term, &e[k], &minor);
        gxb_num_add(&sum, r, &term);
        gxb_num_set(&p, 1, 0);
        gxb_num_mul(r, &sum, &p);
    }
}

/* The same in doubles. *size: the sum of its terms' absolute values */
static double gxp_determinant(const double *const x[4], double *size) {
    double e[3][3], sum = 0;
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) e[i][k] = x[1 + i][k] - x[0][k];
    *size = 0;
    for (k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        sum += e[0][k] * (e[1][p] * e[2][q] - e[1][q] * e[2][p]);
        *size += fabs(e[0][k]) * (fabs(e[1][p] * e[2][q]) + fabs(e[1][q] * e[2][p]));
    }
    return sum;
}

/* Where the terms of volumes cancel by more, weights are computed from exact volumes. */
#define GXP_WEIGHT_LOSS 1e-3

/* The element's barycentric coordinates of a point in it: 0 or more, 1 in sum */
static void gxp_element_weights(const gx_body *body, uint32_t element, const double x[3], double weight[4]) {
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    const double *corner[4], *part[4];
    double sum = 0, sizes = 0;
    int k;
    for (k = 0; k < 4; k++) corner[k] = body->mesh.positions + 3 * (size_t)n[k];
    for (k = 0; k < 4; k++) {
        double size;
        memcpy(part, corner, sizeof part);
        part[k] = x;
        weight[k] = fmax(gxp_determinant(part, &size), 0);
        sum += weight[k];
        sizes += size;
    }
    for (k = 0; k < 4 && !(sum > GXP_WEIGHT_LOSS * sizes); k++) {
        GXB_NUM(own);
        GXB_NUM(whole);
        memcpy(part, corner, sizeof part);
        part[k] = x;
        gxp_exact_determinant(part, &own);
        gxp_exact_determinant(corner, &whole);
        weight[k] = fmax(gxb_num_ratio(&own, &whole), 0);
    }
    for (k = 0, sum = 0; k < 4; k++) sum += weight[k];
    for (k = 0; k < 4; k++) weight[k] /= sum;
}

/* --- making anchors --- */

/* Of a coordinate, about; also the first step towards the inside of a leaf, as a share of the way */
#define GXP_ROUNDING 1.1102230246251565e-16
/* A material point may be off its element, or off what is left there, by this share of the element's size. */
#define GXP_OFF 1e-6

/* Is the point inside the leaf, not on its boundary? */
static int gxp_is_inside_leaf(gx_body *body, uint32_t leaf, const double x[3]) {
    const uint32_t element = gxb_complex_leaf(body->complex, leaf)->element;
    int on;
    return gxb_complex_check_point(body->complex, x) == GX_OK && gxp_element_side(body, element, x) > 0 &&
           gxb_complex_leaf_at(body->complex, element, x, NULL, &on) == leaf && !on;
}

/* The mean of the leaf's points, by their coordinates in the element */
static gx_result gxp_leaf_middle(gx_body *body, uint32_t leaf, double middle[3]) {
    const uint32_t element = gxb_complex_leaf(body->complex, leaf)->element;
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    const gxp_words *points = &body->scratch.leaf_points;
    double sum[4] = {1, 1, 1, 1}, count = 4;
    uint32_t i;
    int j, k;
    if (gxb_complex_leaf(body->complex, leaf)->facet_count > 0) {
        const gx_result result = gxp_collect_leaf_points(body, leaf);
        if (result != GX_OK) return result;
        memset(sum, 0, sizeof sum);
        for (i = 0; i < points->count; i++) {
            double lambda[4];
            gxb_complex_barycentric(body->complex, points->data[i], element, lambda);
            for (j = 0; j < 4; j++) sum[j] += lambda[j];
        }
        count = points->count;
    }
    for (k = 0; k < 3; k++) {
        middle[k] = body->mesh.positions[3 * (size_t)n[0] + (size_t)k];
        for (j = 1; j < 4; j++)
            middle[k] += sum[j] / count *
                         (body->mesh.positions[3 * (size_t)n[j] + (size_t)k] -
                          body->mesh.positions[3 * (size_t)n[0] + (size_t)k]);
    }
    return GX_OK;
}

/* Neighbour i of a point on a lattice of that width: 0 is the point itself, 1 ... 26 are around it. */
static void gxp_neighbour_point(const double x[3], int i, double width, double p[3]) {
    static const int way[3] = {0, 1, -1};
    p[0] = x[0] + way[i % 3] * width;
    p[1] = x[1] + way[i / 3 % 3] * width;
    p[2] = x[2] + way[i / 9] * width;
}

/* The rounding of the element's coordinates, about */
static double gxp_element_rounding(const gx_body *body, uint32_t element) {
    double x[12], most = 0;
    int i;
    gxp_element_positions(body, element, x);
    for (i = 0; i < 12; i++) most = fmax(most, fabs(x[i]));
    return GXP_ROUNDING * most;
}

/* A point inside the leaf: its middle, or a double beside that. *found: 0 if none of these is inside */
static gx_result gxp_find_inside(gx_body *body, uint32_t leaf, double inside[3], int *found) {
    const double width = gxp_element_rounding(body, gxb_complex_leaf(body->complex, leaf)->element);
    double middle[3];
    int i;
    const gx_result result = gxp_leaf_middle(body, leaf, middle);
    *found = 0;
    for (i = 0; i < 27 && result == GX_OK && !*found; i++) {
        gxp_neighbour_point(middle, i, width, inside);
        *found = gxp_is_inside_leaf(body, leaf, inside);
    }
    return result;
}

/* Where an anchor can stand */
typedef struct gxp_footing {
    gx_anchor anchor;
    double moved; /* how far from the point that is asked for, m; until one is found: how far it may be at most */
    int found;
} gxp_footing;

/* Stands at p, if that is in the closed leaf, exactly, and nearer to x than what was found so far. inside: of the leaf.
   Returns 0 if p is not nearer. */
static int gxp_stand(gx_body *body, uint32_t leaf, const double x[3], const double p[3], const double inside[3],
                     gxp_footing *best) {
    const uint32_t element = gxb_complex_leaf(body->complex, leaf)->element;
    double moved = 0;
    int k;
    for (k = 0; k < 3; k++) moved = fmax(moved, fabs(p[k] - x[k]));
    if (moved > best->moved || (best->found && !(moved < best->moved))) return 0;
    if (gxb_complex_check_point(body->complex, p) != GX_OK || gxp_element_side(body, element, p) < 0 ||
        gxb_complex_leaf_at(body->complex, element, p, inside, NULL) != leaf)
        return 1;
    best->anchor.element = element;
    memcpy(best->anchor.position, p, 3 * sizeof *p);
    memcpy(best->anchor.toward, inside, 3 * sizeof *inside);
    best->moved = moved;
    best->found = 1;
    return 0;
}

/* Moves from x towards the inside of a leaf until the leaf has the point. */
static gx_result gxp_try_leaf(gx_body *body, uint32_t leaf, const double x[3], gxp_footing *best) {
    double share = 0, inside[3], p[3];
    int found, k, going = 1;
    const gx_result result = gxp_find_inside(body, leaf, inside, &found);
    while (result == GX_OK && found && going) {
        for (k = 0; k < 3; k++) p[k] = share < 1 ? x[k] + share * (inside[k] - x[k]) : inside[k];
        going = gxp_stand(body, leaf, x, p, inside, best);
        share = share > 0 ? 2 * share : GXP_ROUNDING;
    }
    return result;
}

/* Is the cell kept, and is it the one that was hit, or a part into which that was divided since? hit: NULL, or one
   whose slot is in the cell's element and was there. Copies do not tell: cells on the sides of a sheet that ends beside
   the element share them all. */
static int gxp_is_hit(const gx_body *body, uint32_t cell, const gx_hit *hit) {
    uint32_t slot = body->cells.slot[cell];
    if (!body->cells.data[cell].kept) return 0;
    while (hit != NULL && slot >= hit->slot_count) slot = body->slots.parent[slot];
    return hit == NULL || slot == hit->slot;
}

/* Looks for a leaf of the right cell at x and some roundings around. Stands at x, if the leaf has it, or there. */
static gx_result gxp_try_near(gx_body *body, uint32_t element, const double x[3], const gx_hit *hit,
                              gxp_footing *best) {
    double width = gxp_element_rounding(body, element), p[3], inside[3];
    gx_result result = GX_OK;
    int i, round, found;
    for (round = 0; round < 7 && !best->found; round++, width *= 2)
        for (i = round > 0; i < 27 && !best->found && result == GX_OK; i++) {
            uint32_t leaf = 0;
            gxp_neighbour_point(x, i, width, p);
            if (gxp_leaf_at(body, element, p, NULL, &leaf) != GX_OK || gxp_element_side(body, element, p) < 0 ||
                !gxp_is_kept(body, leaf) || !gxp_is_hit(body, body->leaves.data[leaf].cell, hit))
                continue;
            result = gxp_find_inside(body, leaf, inside, &found);
            if (result == GX_OK && found && gxp_stand(body, leaf, x, x, inside, best))
                (void)gxp_stand(body, leaf, x, p, inside, best);
        }
    return result;
}

/* Finds where an anchor can stand for a point of an element, at most best->moved from it. hit: in the cell that was
   hit, or what is left of it; NULL: in any cell that is left */
static gx_result gxp_find_footing(gx_body *body, uint32_t element, const double x[3], const gx_hit *hit,
                                  gxp_footing *best) {
    gx_result result = gxp_try_near(body, element, x, hit, best);
    const int near = best->found;
    uint32_t cell, leaf;
    for (cell = element; cell != GXP_NONE && result == GX_OK && !near; cell = body->cells.data[cell].next) {
        if (!gxp_is_hit(body, cell, hit)) continue;
        for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
             leaf = body->leaves.data[leaf].next)
            result = gxp_try_leaf(body, leaf, x, best);
    }
    return result;
}

/* The longest side of the element's box, m */
static double gxp_element_size(const gx_body *body, uint32_t element) {
    double x[12], size = 0;
    int i;
    gxp_element_positions(body, element, x);
    for (i = 3; i < 12; i++) size = fmax(size, fabs(x[i] - x[i % 3]));
    return size;
}

GXFEM_API gx_result gx_body_anchor(gx_body *body, uint32_t element, const double material[3], gx_anchor *anchor,
                                   gx_failure *failure) {
    gxp_footing best;
    uint32_t leaf = 0;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (material == NULL) return gxp_refuse(failure, "material");
    if (anchor == NULL) return gxp_refuse(failure, "anchor");
    if (element >= body->mesh.element_count) return gxp_fail(failure, GX_ERROR_INDEX, "element", element);
    result = gxp_leaf_at(body, element, material, NULL, &leaf);
    if (result != GX_OK) return gxp_fail(failure, result, "material", SIZE_MAX);
    memset(&best, 0, sizeof best);
    best.moved = GXP_OFF * gxp_element_size(body, element);
    result = gxp_find_footing(body, element, material, NULL, &best);
    if (gxp_end(failure, result) != GX_OK) return result;
    if (!best.found) {
        const int there = gxp_is_kept(body, leaf) && gxp_element_side(body, element, material) >= 0;
        return gxp_fail(failure, there ? GX_ERROR_FLAT : GX_ERROR_EMPTY, "material", SIZE_MAX);
    }
    *anchor = best.anchor;
    return GX_OK;
}

GXFEM_API gx_result gx_hit_anchor(gx_body *body, const gx_hit *hit, gx_anchor *anchor, gx_failure *failure) {
    gxp_footing best;
    uint32_t cell;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (hit == NULL) return gxp_refuse(failure, "hit");
    if (anchor == NULL) return gxp_refuse(failure, "anchor");
    if (hit->copy_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "hit", SIZE_MAX);
    if (hit->epoch != body->cuts.epoch) return gxp_fail(failure, GX_ERROR_STALE, "hit.epoch", SIZE_MAX);
    if (hit->element >= body->mesh.element_count) return gxp_fail(failure, GX_ERROR_INDEX, "hit.element", SIZE_MAX);
    if (hit->slot >= body->slots.count || hit->slot >= hit->slot_count ||
        gxp_slot_element(body, hit->slot) != hit->element)
        return gxp_fail(failure, GX_ERROR_INDEX, "hit.slot", SIZE_MAX);
    for (cell = hit->element; cell != GXP_NONE && !gxp_is_hit(body, cell, hit);) cell = body->cells.data[cell].next;
    if (cell == GXP_NONE) return gxp_fail(failure, GX_ERROR_EMPTY, "hit.slot", SIZE_MAX);
    result = gxb_complex_check_point(body->complex, hit->material);
    if (result != GX_OK) return gxp_fail(failure, result, "hit.material", SIZE_MAX);
    memset(&best, 0, sizeof best);
    best.moved = 2 * gxp_element_size(body, hit->element);
    result = gxp_find_footing(body, hit->element, hit->material, hit, &best);
    if (gxp_end(failure, result) != GX_OK) return result;
    if (!best.found) return gxp_fail(failure, GX_ERROR_FLAT, "hit.material", SIZE_MAX);
    *anchor = best.anchor;
    return GX_OK;
}

/* >>regions: what is held ------------------------------------------------------------------------------------------ */
/* In: regions that are to be held, with all that they point to. Out: the body's copy of them, checked; the nodes in
   each. Touches the tables of regions and the lists of their nodes. */

/* Counts of the tables of regions and of the lists of nodes: what a call that fails goes back to */
typedef struct gxp_extent {
    uint32_t regions, indices, vertices, nodes;
} gxp_extent;

static gxp_extent gxp_holds_extent(const gxp_holds *holds) {
    gxp_extent extent;
    extent.regions = holds->count;
    extent.indices = holds->index_count;
    extent.vertices = holds->vertex_count;
    extent.nodes = holds->nodes.count;
    return extent;
}

/* Forgets the regions beyond an extent. */
static void gxp_cut_holds(gxp_holds *holds, const gxp_extent *extent) {
    holds->count = extent->regions;
    holds->index_count = extent->indices;
    holds->vertex_count = extent->vertices;
    holds->nodes.count = extent->nodes;
    holds->node_first.count = extent->regions + 1;
}

/* Forgets the regions before an extent: the others move down. */
static void gxp_drop_holds(gxp_holds *holds, const gxp_extent *first) {
    uint32_t i;
    for (i = first->regions; i < holds->count; i++) {
        gxp_region *r = &holds->regions[i - first->regions];
        *r = holds->regions[i];
        r->first_index -= first->indices;
        r->first_vertex -= first->vertices;
        holds->node_first.data[i - first->regions] = holds->node_first.data[i] - first->nodes;
    }
    holds->count -= first->regions;
    holds->index_count -= first->indices;
    holds->vertex_count -= first->vertices;
    holds->nodes.count -= first->nodes;
    holds->node_first.data[holds->count] = holds->nodes.count;
    holds->node_first.count = holds->count + 1;
    if (holds->index_count > 0)
        memmove(holds->indices, holds->indices + first->indices, holds->index_count * sizeof *holds->indices);
    if (holds->vertex_count > 0)
        memmove(holds->vertices, holds->vertices + 3 * (size_t)first->vertices,
                3 * (size_t)holds->vertex_count * sizeof *holds->vertices);
    if (holds->nodes.count > 0)
        memmove(holds->nodes.data, holds->nodes.data + first->nodes, holds->nodes.count * sizeof *holds->nodes.data);
}

/* Appends indices, or vertices, to the last region. */
static gx_result gxp_add_indices(gx_body *body, const uint32_t *indices, size_t count) {
    gxp_holds *holds = &body->holds;
    const gx_result result = gxp_grow_rows(body, GXP_REGION_INDICES, count);
    if (result != GX_OK) return result;
    if (count > 0) memcpy(holds->indices + holds->index_count, indices, count * sizeof *indices);
    holds->index_count += (uint32_t)count;
    holds->regions[holds->count - 1].index_count += (uint32_t)count;
    return GX_OK;
}
static gx_result gxp_add_vertices(gx_body *body, const double *vertices, size_t count) {
    gxp_holds *holds = &body->holds;
    const gx_result result = gxp_grow_rows(body, GXP_REGION_VERTICES, count);
    if (result != GX_OK) return result;
    if (count > 0) memcpy(holds->vertices + 3 * (size_t)holds->vertex_count, vertices, 3 * count * sizeof *vertices);
    holds->vertex_count += (uint32_t)count;
    holds->regions[holds->count - 1].vertex_count += (uint32_t)count;
    return GX_OK;
}

static gx_result gxp_copy_surface(gx_body *body, const gx_surface *s, size_t index, gx_failure *failure) {
    gx_result result;
    if (s == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.surface", index);
    if (s->vertex_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "regions.surface.vertex_count", index);
    if (s->triangle_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "regions.surface.triangle_count", index);
    if (s->vertices == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.surface.vertices", index);
    if (s->triangles == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.surface.triangles", index);
    if (s->vertex_count > INT32_MAX / 4)
        return gxp_fail(failure, GX_ERROR_LIMIT, "regions.surface.vertex_count", index);
    if (s->triangle_count > INT32_MAX / 4)
        return gxp_fail(failure, GX_ERROR_LIMIT, "regions.surface.triangle_count", index);
    result = gxp_add_indices(body, s->triangles, 3 * s->triangle_count);
    if (result == GX_OK) result = gxp_add_vertices(body, s->vertices, s->vertex_count);
    return gxp_end(failure, result);
}

static gx_result gxp_copy_nodes(gx_body *body, const gx_region *given, size_t index, gx_failure *failure) {
    if (given->node_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "regions.node_count", index);
    if (given->nodes == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.nodes", index);
    if (given->node_count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "regions.node_count", index);
    return gxp_end(failure, gxp_add_indices(body, given->nodes, given->node_count));
}

/* An anchor as an index, its element, and two vertices: position, toward */
static gx_result gxp_copy_anchors(gx_body *body, const gx_region *given, size_t index, gx_failure *failure) {
    gx_result result = GX_OK;
    size_t i;
    if (given->anchor_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "regions.anchor_count", index);
    if (given->anchors == NULL) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.anchors", index);
    if (given->anchor_count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "regions.anchor_count", index);
    for (i = 0; i < given->anchor_count && result == GX_OK; i++) {
        result = gxp_add_indices(body, &given->anchors[i].element, 1);
        if (result == GX_OK) result = gxp_add_vertices(body, given->anchors[i].position, 1);
        if (result == GX_OK) result = gxp_add_vertices(body, given->anchors[i].toward, 1);
    }
    return gxp_end(failure, result);
}

/* Appends the body's copy of a region; its numbers are checked later. index: for the failure */
static gx_result gxp_copy_region(gx_body *body, const gx_region *given, size_t index, gx_failure *failure) {
    gxp_holds *holds = &body->holds;
    gx_result result = gxp_grow_rows(body, GXP_REGIONS, 1);
    gxp_region *r;
    if (gxp_end(failure, result) != GX_OK) return result;
    r = &holds->regions[holds->count++];
    memset(r, 0, sizeof *r);
    r->kind = given->kind;
    r->first_index = holds->index_count;
    r->first_vertex = holds->vertex_count;
    switch (given->kind) {
    case GX_REGION_HALF_SPACE:
        r->axis = given->axis;
        r->side = given->side;
        r->value = given->value;
        return GX_OK;
    case GX_REGION_BOX:
        memcpy(r->low, given->low, sizeof r->low);
        memcpy(r->high, given->high, sizeof r->high);
        return GX_OK;
    case GX_REGION_SPHERE:
        memcpy(r->center, given->center, sizeof r->center);
        r->radius = given->radius;
        return GX_OK;
    case GX_REGION_SURFACE: return gxp_copy_surface(body, given->surface, index, failure);
    case GX_REGION_NODES: return gxp_copy_nodes(body, given, index, failure);
    case GX_REGION_ANCHORS: return gxp_copy_anchors(body, given, index, failure);
    }
    return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.kind", index);
}

/* --- checks, also of what is read --- */

static gx_anchor gxp_region_anchor(const gx_body *body, const gxp_region *r, uint32_t i) {
    const double *x = body->holds.vertices + 3 * ((size_t)r->first_vertex + 2 * (size_t)i);
    gx_anchor anchor;
    memset(&anchor, 0, sizeof anchor);
    anchor.element = body->holds.indices[r->first_index + i];
    memcpy(anchor.position, x, sizeof anchor.position);
    memcpy(anchor.toward, x + 3, sizeof anchor.toward);
    return anchor;
}

static gx_result gxp_check_half_space(const gxp_region *r, size_t index, gx_failure *failure) {
    if (r->axis > 2) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.axis", index);
    if (r->side != 1 && r->side != -1) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.side", index);
    return gxp_is_finite(r->value) ? GX_OK : gxp_fail(failure, GX_ERROR_NOT_FINITE, "regions.value", index);
}

static gx_result gxp_check_box(const gx_body *body, const gxp_region *r, size_t index, gx_failure *failure) {
    gx_result result = gxb_complex_check_point(body->complex, r->low);
    int k;
    if (result != GX_OK) return gxp_fail(failure, result, "regions.low", index);
    result = gxb_complex_check_point(body->complex, r->high);
    if (result != GX_OK) return gxp_fail(failure, result, "regions.high", index);
    for (k = 0; k < 3; k++)
        if (!(r->low[k] < r->high[k])) return gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.high", index);
    return GX_OK;
}

static gx_result gxp_check_sphere(const gx_body *body, const gxp_region *r, size_t index, gx_failure *failure) {
    const gx_result result = gxb_complex_check_point(body->complex, r->center);
    if (result != GX_OK) return gxp_fail(failure, result, "regions.center", index);
    if (!gxp_is_finite(r->radius)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "regions.radius", index);
    return r->radius > 0 ? GX_OK : gxp_fail(failure, GX_ERROR_ARGUMENT, "regions.radius", index);
}

/* Is the surface closed, its triangles oriented alike? */
static gx_result gxp_check_shell(gx_body *body, const gx_surface *shell, size_t index, gx_failure *failure) {
    const gx_allocator *a = &body->config.allocator;
    const size_t merged = shell->vertex_count * sizeof(uint32_t),
                 edges = 3 * shell->triangle_count * sizeof(gxp_half_edge);
    gxp_surface s;
    gxp_cut cut;
    gx_result result = GX_ERROR_MEMORY;
    memset(&s, 0, sizeof s);
    memset(&cut, 0, sizeof cut);
    s.given = shell;
    s.merged = (uint32_t *)gxp_allocate(a, merged);
    s.edges = (gxp_half_edge *)gxp_allocate(a, edges);
    if (s.merged != NULL && s.edges != NULL) result = gxp_merge_vertices(body, &s);
    if (result == GX_OK) {
        gxp_sort_edges(&s);
        result = gxp_check_closed(&cut, &s);
    }
    gxp_release(a, s.merged, merged);
    gxp_release(a, s.edges, edges);
    return result == GX_ERROR_NOT_CLOSED ? gxp_fail(failure, result, "regions.surface.triangles", index)
                                         : gxp_end(failure, result);
}

/* The closed surface of a region, in the body's arrays */
static gx_surface gxp_region_shell(const gx_body *body, const gxp_region *r) {
    gx_surface shell;
    memset(&shell, 0, sizeof shell);
    shell.vertices = body->holds.vertices + 3 * (size_t)r->first_vertex;
    shell.vertex_count = r->vertex_count;
    shell.triangles = body->holds.indices + r->first_index;
    shell.triangle_count = r->index_count / 3;
    return shell;
}

static gx_result gxp_check_region_surface(gx_body *body, const gxp_region *r, size_t index, gx_failure *failure) {
    const gx_surface shell = gxp_region_shell(body, r);
    size_t i;
    for (i = 0; i < shell.vertex_count; i++) {
        const gx_result result = gxb_complex_check_point(body->complex, shell.vertices + 3 * i);
        if (result != GX_OK) return gxp_fail(failure, result, "regions.surface.vertices", index);
    }
    for (i = 0; i < 3 * shell.triangle_count; i++)
        if (shell.triangles[i] >= shell.vertex_count)
            return gxp_fail(failure, GX_ERROR_INDEX, "regions.surface.triangles", index);
    return gxp_check_shell(body, &shell, index, failure);
}

static gx_result gxp_check_region_lists(const gx_body *body, const gxp_region *r, size_t index, gx_failure *failure) {
    static const char *const names[3] = {"regions.anchors.element", "regions.anchors.position",
                                         "regions.anchors.toward"};
    gx_result result = GX_OK;
    uint32_t i;
    for (i = 0; i < r->index_count && result == GX_OK; i++) {
        if (r->kind == GX_REGION_ANCHORS) {
            const gx_anchor anchor = gxp_region_anchor(body, r, i);
            result = gxp_check_anchor(body, &anchor, names, index, failure);
        } else if (body->holds.indices[r->first_index + i] >= body->mesh.node_count)
            result = gxp_fail(failure, GX_ERROR_INDEX, "regions.nodes", index);
    }
    return result;
}

/* Numbers, indices and shape of a region in the body's tables; index: for the failure */
static gx_result gxp_check_region(gx_body *body, const gxp_region *r, size_t index, gx_failure *failure) {
    switch (r->kind) {
    case GX_REGION_HALF_SPACE: return gxp_check_half_space(r, index, failure);
    case GX_REGION_BOX: return gxp_check_box(body, r, index, failure);
    case GX_REGION_SPHERE: return gxp_check_sphere(body, r, index, failure);
    case GX_REGION_SURFACE: return gxp_check_region_surface(body, r, index, failure);
    default: return gxp_check_region_lists(body, r, index, failure);
    }
}

/* --- the nodes in a region --- */

/* |x - center|^2 - radius^2, exact */
static GXP_COLD int gxp_exact_ball_side(const double x[3], const double center[3], double radius) {
    int k;
    GXB_NUM(a);
    GXB_NUM(b);
    GXB_NUM(d);
    GXB_NUM(square);
    GXB_NUM(sum);
    gxb_num_set(&a, radius, 0);
    gxb_num_mul(&square, &a, &a);
    for (k = 0; k < 3; k++) {
        gxb_num_set(&a, x[k], 0);
        gxb_num_set(&b, center[k], 0);
        gxb_num_sub(&d, &a, &b);
        gxb_num_mul(&b, &d, &d);
        gxb_num_sub(&sum, &square, &b);
        gxb_num_set(&a, 1, 0);
        gxb_num_mul(&square, &sum, &a);
    }
    return -square.sign;
}

/* Is the point strictly inside the ball? Exact */
static int gxp_is_in_ball(const double x[3], const double center[3], double radius) {
    double square = 0, size = radius * radius;
    int k;
    for (k = 0; k < 3; k++) {
        square += (x[k] - center[k]) * (x[k] - center[k]);
        size += x[k] * x[k] + center[k] * center[k];
    }
    if (fabs(square - radius * radius) > 1e-14 * size && size > 1e-280) /* not where the size is infinite, or NaN */
        return square < radius * radius;
    return gxp_exact_ball_side(x, center, radius) < 0;
}

static int gxp_is_node_inside(const gx_body *body, const gxp_region *r, uint32_t node) {
    const double *x = body->mesh.positions + 3 * (size_t)node;
    int on_surface, k;
    switch (r->kind) {
    case GX_REGION_HALF_SPACE: return r->side < 0 ? x[r->axis] < r->value : x[r->axis] > r->value;
    case GX_REGION_BOX:
        for (k = 0; k < 3; k++)
            if (!(x[k] > r->low[k] && x[k] < r->high[k])) return 0;
        return 1;
    case GX_REGION_SPHERE: return gxp_is_in_ball(x, r->center, r->radius);
    default: {
        const gx_surface shell = gxp_region_shell(body, r);
        const int winding = gxb_winding_number(shell.vertices, shell.triangles, shell.triangle_count, x, &on_surface);
        return winding != 0 && !on_surface;
    }
    }
}

/* A box around the region, which may be infinite */
static void gxp_region_bounds(const gx_body *body, const gxp_region *r, double low[3], double high[3]) {
    uint32_t i;
    int k;
    for (k = 0; k < 3; k++) {
        low[k] = -1e308;
        high[k] = 1e308;
        if (r->kind == GX_REGION_HALF_SPACE && r->axis == (uint32_t)k) {
            if (r->side < 0) high[k] = r->value;
            if (r->side > 0) low[k] = r->value;
        }
        if (r->kind == GX_REGION_BOX) {
            low[k] = r->low[k];
            high[k] = r->high[k];
        }
        if (r->kind == GX_REGION_SPHERE) {
            const double margin = 1e-14 * (fabs(r->center[k]) + r->radius);
            low[k] = r->center[k] - r->radius - margin;
            high[k] = r->center[k] + r->radius + margin;
        }
        if (r->kind != GX_REGION_SURFACE) continue;
        low[k] = 1e308;
        high[k] = -1e308;
        for (i = 0; i < r->vertex_count; i++) {
            low[k] = fmin(low[k], body->holds.vertices[3 * ((size_t)r->first_vertex + i) + (size_t)k]);
            high[k] = fmax(high[k], body->holds.vertices[3 * ((size_t)r->first_vertex + i) + (size_t)k]);
        }
    }
}

static int gxp_boxes_meet(const double *low, const double *high, const double *other_low, const double *other_high) {
    return low[0] <= other_high[0] && high[0] >= other_low[0] && low[1] <= other_high[1] && high[1] >= other_low[1] &&
           low[2] <= other_high[2] && high[2] >= other_low[2];
}

/* Lists the nodes of elements near a box; some more than once. */
static gx_result gxp_push_near_nodes(gx_body *body, const double low[3], const double high[3], gxp_words *nodes) {
    uint32_t stack[128], depth = 0, i, k;
    gx_result result = GX_OK;
    stack[depth++] = 0;
    while (depth > 0 && result == GX_OK) {
        const gxp_box *box = &body->mesh.boxes[stack[--depth]];
        if (!gxp_boxes_meet(low, high, box->low, box->high)) continue;
        if (box->count == 0) {
            stack[depth++] = box->first + 1;
            stack[depth++] = box->first;
        }
        for (i = 0; i < box->count; i++)
            for (k = 0; k < 4 && result == GX_OK; k++)
                result = gxp_push(body, nodes,
                                  gxb_complex_element_nodes(body->complex, body->mesh.box_elements[box->first + i])[k]);
    }
    return result;
}

/* Appends the nodes in a region, ascending, to the lists; these have those of all regions before it. */
static gx_result gxp_list_nodes(gx_body *body, const gxp_region *r) {
    gxp_holds *holds = &body->holds;
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    uint32_t i;
    gx_result result = gxp_start_words(body, &holds->near_nodes, r->index_count);
    if (result != GX_OK) return result;
    if (r->kind == GX_REGION_NODES) {
        memcpy(holds->near_nodes.data, holds->indices + r->first_index, r->index_count * sizeof *holds->indices);
        holds->near_nodes.count = r->index_count;
    } else if (r->kind != GX_REGION_ANCHORS) {
        gxp_region_bounds(body, r, low, high);
        result = gxp_push_near_nodes(body, low, high, &holds->near_nodes);
    }
    gxp_sort_unique(&holds->near_nodes);
    for (i = 0; i < holds->near_nodes.count && result == GX_OK; i++) {
        const double *x = body->mesh.positions + 3 * (size_t)holds->near_nodes.data[i];
        if (r->kind == GX_REGION_NODES ||
            (gxp_boxes_meet(x, x, low, high) && gxp_is_node_inside(body, r, holds->near_nodes.data[i])))
            result = gxp_push(body, &holds->nodes, holds->near_nodes.data[i]);
    }
    return result == GX_OK ? gxp_push(body, &holds->node_first, holds->nodes.count) : result;
}

/* Lists the nodes in all regions, unless they are listed. */
static gx_result gxp_list_all_nodes(gx_body *body) {
    gxp_holds *holds = &body->holds;
    uint32_t r;
    gx_result result;
    if (holds->listed) return GX_OK;
    holds->nodes.count = holds->node_first.count = 0;
    result = gxp_push(body, &holds->node_first, 0);
    for (r = 0; r < holds->count && result == GX_OK; r++) result = gxp_list_nodes(body, &holds->regions[r]);
    if (result == GX_OK) holds->listed = 1;
    return result;
}

/* >>grips: held copies --------------------------------------------------------------------------------------------- */
/* In: regions and the nodes in them. Out: for each copy the first region that holds it, found anew after a cut or when
   regions change. A copy is held if its node is in the region and one of its own cells has material there. Most cells
   have the node as a corner, and material beside it. The others lie behind a wall. Whether a box or a surface reaches
   them is what the complex tells when its triangles are inserted, in a transaction that is taken back. Touches held
   flags and rest times of copies. */

/* Corners of a box by bits: 1, 2, 4 for its high side along each axis */
static const uint32_t gxp_box_triangles[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                               2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/* The part of a box near the mesh, as a surface with these corners */
static gx_surface gxp_box_shell(const gx_body *body, const gxp_region *r, double corners[24]) {
    const gxp_box *all = &body->mesh.boxes[0];
    gx_surface shell;
    uint32_t i;
    int k;
    for (i = 0; i < 8; i++)
        for (k = 0; k < 3; k++) {
            const double size = all->high[k] - all->low[k] + fabs(all->low[k]) + fabs(all->high[k]);
            corners[3 * i + (uint32_t)k] =
                i >> k & 1 ? fmin(r->high[k], all->high[k] + size) : fmax(r->low[k], all->low[k] - size);
        }
    memset(&shell, 0, sizeof shell);
    shell.vertices = corners;
    shell.vertex_count = 8;
    shell.triangles = gxp_box_triangles;
    shell.triangle_count = 12;
    return shell;
}

/* Makes the surface of a region the one that is asked about; opens the transaction. */
static gx_result gxp_begin_probe(gx_body *body, const gxp_region *r) {
    gxp_probe *probe = &body->holds.probe;
    gx_result result;
    size_t i;
    if (probe->region == r) return GX_OK;
    if (probe->region == NULL) gxb_complex_begin(body->complex);
    probe->region = r;
    probe->shell = r->kind == GX_REGION_BOX ? gxp_box_shell(body, r, probe->corners) : gxp_region_shell(body, r);
    result = gxp_start_words(body, &probe->points, probe->shell.vertex_count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &probe->triangles, sizeof *probe->triangles, 0,
                             &probe->triangle_capacity, probe->shell.triangle_count);
    if (result != GX_OK) return result;
    memset(probe->points.data, 0xff, probe->shell.vertex_count * sizeof *probe->points.data);
    for (i = 0; i < probe->shell.triangle_count; i++) probe->triangles[i].plane = GXP_NONE;
    return GX_OK;
}

static void gxp_end_probe(gx_body *body) {
    if (body->holds.probe.region != NULL) gxb_complex_rollback(body->complex);
    body->holds.probe.region = NULL;
}

/* Gives a triangle of the surface its points and its plane in the complex, unless it has them. */
static gx_result gxp_probe_triangle(gx_body *body, uint32_t index) {
    gxp_probe *probe = &body->holds.probe;
    gxb_triangle *t = &probe->triangles[index];
    uint32_t k;
    gx_result result = GX_OK;
    if (t->plane != GXP_NONE) return GX_OK;
    memset(t, 0, sizeof *t);
    for (k = 0; k < 3 && result == GX_OK; k++) {
        const uint32_t v = probe->shell.triangles[3 * index + k];
        if (probe->points.data[v] == GXP_NONE)
            result =
                gxb_complex_add_point(body->complex, probe->shell.vertices + 3 * (size_t)v, &probe->points.data[v]);
        t->point[k] = probe->points.data[v];
    }
    return result == GX_OK ? gxb_complex_add_plane(body->complex, t) : result;
}

/* Notes a leaf of which the triangle has a part, and has the complex leave it alone. */
static int gxp_note_reached(void *user, uint32_t leaf) {
    gx_body *body = (gx_body *)user;
    const gx_result result = gxp_push(body, &body->holds.probe.reached, leaf);
    if (result != GX_OK) body->holds.probe.result = result;
    return 0;
}

/* Stamps the leaves that the plane of a triangle divides, of those that it reached. It may cover a facet of others. */
static gx_result gxp_stamp_reached(gx_body *body, uint32_t plane) {
    const gxp_words *reached = &body->holds.probe.reached;
    gx_result result = GX_OK;
    uint32_t i, j;
    for (i = 0; i < reached->count && result == GX_OK; i++) {
        int sides = 0;
        if (body->leaves.mark[reached->data[i]].stamp == body->scratch.stamp) continue;
        result = gxp_collect_leaf_points(body, reached->data[i]);
        for (j = 0; j < body->scratch.leaf_points.count && result == GX_OK; j++) {
            const int side = gxb_complex_side(body->complex, body->scratch.leaf_points.data[j], plane);
            sides |= side > 0 ? 1 : side < 0 ? 2 : 0;
        }
        if (sides == 3) body->leaves.mark[reached->data[i]].stamp = body->scratch.stamp;
    }
    return result;
}

/* Stamps the leaves of an element through whose inside the surface of a region passes. */
static gx_result gxp_reach_element(gx_body *body, const gxp_region *r, uint32_t element) {
    gxp_probe *probe = &body->holds.probe;
    double x[12], low[3], high[3];
    uint32_t t;
    int i, k;
    gx_result result = gxp_begin_probe(body, r);
    gxp_element_positions(body, element, x);
    for (k = 0; k < 3; k++) {
        low[k] = high[k] = x[k];
        for (i = 1; i < 4; i++) {
            low[k] = fmin(low[k], x[3 * i + k]);
            high[k] = fmax(high[k], x[3 * i + k]);
        }
    }
    body->scratch.stamp++;
    for (t = 0; t < probe->shell.triangle_count && result == GX_OK; t++) {
        const uint32_t *n = probe->shell.triangles + 3 * (size_t)t;
        const double *a = probe->shell.vertices + 3 * (size_t)n[0], *b = probe->shell.vertices + 3 * (size_t)n[1],
                     *c = probe->shell.vertices + 3 * (size_t)n[2];
        double least[3], most[3];
        for (k = 0; k < 3; k++) {
            least[k] = fmin(a[k], fmin(b[k], c[k]));
            most[k] = fmax(a[k], fmax(b[k], c[k]));
        }
        if (!gxp_boxes_meet(least, most, low, high) || gxp_is_flat(a, b, c)) continue;
        probe->reached.count = 0;
        probe->result = GX_OK;
        result = gxp_probe_triangle(body, t);
        if (result == GX_OK)
            result = gxb_complex_insert(body->complex, &probe->triangles[t], element, gxp_note_reached, body);
        if (result == GX_OK) result = probe->result;
        if (result == GX_OK) result = gxp_stamp_reached(body, probe->triangles[t].plane);
    }
    return result;
}

/* |p|^2 of the point of a segment that is nearest to the origin */
static double gxp_segment_square(const double a[3], const double b[3]) {
    const double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, length = gxp_dot(way, way);
    const double t = length > 0 ? fmin(fmax(-gxp_dot(a, way) / length, 0), 1) : 0;
    const double p[3] = {a[0] + t * way[0], a[1] + t * way[1], a[2] + t * way[2]};
    return gxp_dot(p, p);
}

/* The same of a triangle x = a b c */
static double gxp_triangle_square(const double x[9]) {
    static const uint32_t corners[3] = {0, 1, 2};
    double n[3], square, height;
    int k, inside = 1;
    gxp_triangle_normal(x, corners, n);
    square = gxp_dot(n, n);
    for (k = 0; k < 3; k++) { /* the origin's projection is on the inner side of each edge */
        const double *a = x + 3 * k, *b = x + 3 * ((k + 1) % 3), way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        const double side[3] = {n[1] * way[2] - n[2] * way[1], n[2] * way[0] - n[0] * way[2],
                                n[0] * way[1] - n[1] * way[0]};
        inside &= gxp_dot(side, a) <= 0;
    }
    height = gxp_dot(n, x);
    if (inside && square > 0) return height * height / square;
    return fmin(gxp_segment_square(x, x + 3), fmin(gxp_segment_square(x + 3, x + 6), gxp_segment_square(x + 6, x)));
}

/* A point of the complex less a centre, rounded */
static void gxp_point_from(gx_body *body, uint32_t point, uint32_t element, const double center[3], double x[3]) {
    const uint32_t *n = gxb_complex_element_nodes(body->complex, element);
    double lambda[4];
    int j, k;
    gxb_complex_barycentric(body->complex, point, element, lambda);
    for (k = 0; k < 3; k++) {
        x[k] = 0;
        for (j = 0; j < 4; j++) x[k] += lambda[j] * (body->mesh.positions[3 * (size_t)n[j] + (size_t)k] - center[k]);
    }
}

/* Does the leaf reach into the ball? Its points are rounded, so a leaf that only touches the ball may be taken either
   way. */
static gx_result gxp_leaf_in_ball(gx_body *body, uint32_t leaf, const gxp_region *r, int *inside) {
    gxb_complex *cx = body->complex;
    const uint32_t element = gxb_complex_leaf(cx, leaf)->element;
    const gxp_words *points = &body->scratch.facet_points;
    uint32_t first, count = 0, i, j;
    double x[9];
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    *inside = gxp_element_side(body, element, r->center) >= 0 &&
              gxb_complex_leaf_at(cx, element, r->center, NULL, NULL) == leaf;
    for (i = 0; i < count && result == GX_OK && !*inside; i++) {
        result = gxp_collect_facet_points(body, gxp_item(cx, first + i));
        if (result == GX_OK) gxp_point_from(body, points->data[0], element, r->center, x);
        for (j = 1; j + 1 < points->count && result == GX_OK && !*inside; j++) {
            gxp_point_from(body, points->data[j], element, r->center, x + 3);
            gxp_point_from(body, points->data[j + 1], element, r->center, x + 6);
            *inside = gxp_triangle_square(x) < r->radius * r->radius;
        }
    }
    return result;
}

/* Does a leaf have material in a region? Of a box or a surface gxp_reach_element has stamped the leaves that its
   surface divides; others are inside or outside as a whole. */
static gx_result gxp_leaf_in_region(gx_body *body, uint32_t leaf, const gxp_region *r, int *inside) {
    const gxp_words *points = &body->scratch.leaf_points;
    const gx_surface *shell = &body->holds.probe.shell;
    uint32_t i;
    gx_result result;
    if (r->kind == GX_REGION_SPHERE) return gxp_leaf_in_ball(body, leaf, r, inside);
    *inside = r->kind != GX_REGION_HALF_SPACE && body->leaves.mark[leaf].stamp == body->scratch.stamp;
    if (*inside) return GX_OK;
    result = gxp_collect_leaf_points(body, leaf);
    if (result != GX_OK) return result;
    if (r->kind != GX_REGION_HALF_SPACE)
        *inside = gxb_complex_winding(body->complex, points->data, points->count, shell->vertices, shell->triangles,
                                      shell->triangle_count) != 0;
    for (i = 0; i < points->count && r->kind == GX_REGION_HALF_SPACE && !*inside; i++)
        *inside = gxb_complex_compare(body->complex, points->data[i], (int)r->axis, r->value) * r->side > 0;
    return GX_OK;
}

/* Is the node a corner of the cell? */
static gx_result gxp_has_corner(gx_body *body, uint32_t cell, uint32_t node, int *corner) {
    const gxp_words *points = &body->scratch.leaf_points;
    uint32_t leaf, i;
    gx_result result = GX_OK;
    *corner = 0;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK && !*corner;
         leaf = body->leaves.data[leaf].next) {
        if (gxb_complex_leaf(body->complex, leaf)->facet_count == 0) {
            *corner = 1;
            continue;
        }
        result = gxp_collect_leaf_points(body, leaf);
        for (i = 0; i < points->count && result == GX_OK && !*corner; i++) *corner = points->data[i] == node;
    }
    return result;
}

/* Does a cell around a node in a region have material in the region? *reached: 1 if the region's surface has been asked
   about for this element */
static gx_result gxp_cell_in_region(gx_body *body, uint32_t cell, uint32_t node, const gxp_region *r, int *reached,
                                    int *inside) {
    uint32_t leaf;
    gx_result result = gxp_has_corner(body, cell, node, inside);
    if (*inside || r->kind == GX_REGION_NODES || result != GX_OK) return result;
    if ((r->kind == GX_REGION_BOX || r->kind == GX_REGION_SURFACE) && !*reached) {
        result = gxp_reach_element(body, r, body->cells.data[cell].element);
        *reached = 1;
    }
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK && !*inside;
         leaf = body->leaves.data[leaf].next)
        result = gxp_leaf_in_region(body, leaf, r, inside);
    return result;
}

/* Gives the copies of a node that a region holds to it, unless earlier regions have them. region_of NULL: only asks if
   there is any. */
static gx_result gxp_hold_node(gx_body *body, uint32_t region, uint32_t node, uint32_t *region_of, int *any) {
    const gxp_region *r = &body->holds.regions[region];
    uint32_t j, cell;
    gx_result result = GX_OK;
    for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1]; j++) {
        const int k = gxp_local_node(body, body->mesh.node_elements[j], node);
        int reached = 0, inside;
        for (cell = body->mesh.node_elements[j]; cell != GXP_NONE && result == GX_OK;
             cell = body->cells.data[cell].next) {
            const gxp_cell *c = &body->cells.data[cell];
            if (!c->kept || (region_of != NULL ? region_of[c->copies[k]] != GXP_NONE : *any)) continue;
            result = gxp_cell_in_region(body, cell, node, r, &reached, &inside);
            if (!inside || result != GX_OK) continue;
            *any = 1;
            if (region_of != NULL) region_of[c->copies[k]] = region;
        }
    }
    return result;
}

/* The same for the copies that move a region's anchors */
static void gxp_hold_anchors(gx_body *body, uint32_t region, uint32_t *region_of, int *any) {
    const gxp_region *r = &body->holds.regions[region];
    uint32_t i;
    int k;
    for (i = 0; i < r->index_count; i++) {
        const gx_anchor anchor = gxp_region_anchor(body, r, i);
        const uint32_t cell = gxp_anchor_cell(body, &anchor);
        double weight[4];
        if (cell == GXP_NONE) continue;
        *any = 1;
        gxp_element_weights(body, anchor.element, anchor.position, weight);
        for (k = 0; k < 4 && region_of != NULL; k++)
            if (weight[k] > 0 && region_of[body->cells.data[cell].copies[k]] == GXP_NONE)
                region_of[body->cells.data[cell].copies[k]] = region;
    }
}

static gx_result gxp_hold_region(gx_body *body, uint32_t region, uint32_t *region_of, int *any) {
    const gxp_holds *holds = &body->holds;
    gx_result result = GX_OK;
    uint32_t i;
    if (holds->regions[region].kind == GX_REGION_ANCHORS) gxp_hold_anchors(body, region, region_of, any);
    for (i = holds->node_first.data[region]; i < holds->node_first.data[region + 1] && result == GX_OK; i++)
        if (region_of != NULL || !*any) result = gxp_hold_node(body, region, holds->nodes.data[i], region_of, any);
    return result;
}

/* Finds anew which region holds which copy, if there has been a cut or regions have changed. */
static gx_result gxp_find_held(gx_body *body) {
    gxp_holds *holds = &body->holds;
    uint32_t r;
    int any = 0;
    gx_result result;
    if (!holds->stale) return GX_OK;
    result = gxp_list_all_nodes(body);
    if (result == GX_OK) result = gxp_start_words(body, &holds->region_of, (size_t)body->copies.count + 1);
    if (result != GX_OK) return result;
    memset(holds->region_of.data, 0xff, body->copies.count * sizeof *holds->region_of.data);
    for (r = 0; r < holds->count && result == GX_OK; r++)
        result = gxp_hold_region(body, r, holds->region_of.data, &any);
    gxp_end_probe(body);
    return result;
}

/* Flags the held copies that were found. */
static void gxp_flag_held(gx_body *body) {
    uint32_t c;
    if (!body->holds.stale) return;
    for (c = 0; c < body->copies.count; c++) {
        const int held = body->holds.region_of.data[c] != GXP_NONE;
        if (body->copies.held[c] && !held) body->copies.rest_time[c] = 0; /* released copies wake */
        body->copies.held[c] = (uint8_t)held;
    }
    body->holds.stale = 0;
}

static gx_result gxp_update_held(gx_body *body) {
    const gx_result result = gxp_find_held(body);
    if (result == GX_OK) gxp_flag_held(body);
    return result;
}

/* Takes a region over and refuses one that holds no copy. index: for the failure */
static gx_result gxp_take_region(gx_body *body, const gx_region *given, size_t index, gx_failure *failure) {
    gxp_holds *holds = &body->holds;
    int any = 0;
    gx_result result = gxp_copy_region(body, given, index, failure);
    if (result == GX_OK) result = gxp_check_region(body, &holds->regions[holds->count - 1], index, failure);
    if (result != GX_OK) return result;
    result = gxp_list_nodes(body, &holds->regions[holds->count - 1]);
    if (result == GX_OK) result = gxp_hold_region(body, holds->count - 1, NULL, &any);
    gxp_end_probe(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    return any ? GX_OK : gxp_fail(failure, GX_ERROR_EMPTY, "regions", index);
}

GXFEM_API gx_result gx_body_hold(gx_body *body, const gx_region *regions, size_t region_count, gx_failure *failure) {
    gxp_extent before;
    gx_result result;
    size_t i;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (region_count > 0 && regions == NULL) return gxp_refuse(failure, "regions");
    if (region_count > INT32_MAX / 2) return gxp_fail(failure, GX_ERROR_LIMIT, "region_count", SIZE_MAX);
    result = gxp_list_all_nodes(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    before = gxp_holds_extent(&body->holds);
    for (i = 0; i < region_count && result == GX_OK; i++) result = gxp_take_region(body, &regions[i], i, failure);
    if (result != GX_OK) {
        gxp_cut_holds(&body->holds, &before);
        return result;
    }
    gxp_drop_holds(&body->holds, &before);
    body->holds.stale = 1;
    body->model.state = GXP_MODEL_STALE;
    return GX_OK;
}

GXFEM_API gx_region gx_region_half_space(uint32_t axis, int side, double value) {
    gx_region region;
    memset(&region, 0, sizeof region);
    region.axis = axis;
    region.side = side;
    region.value = value;
    return region;
}

GXFEM_API gx_region gx_region_box(const double low[3], const double high[3]) {
    gx_region region;
    memset(&region, 0, sizeof region);
    region.kind = GX_REGION_BOX;
    memcpy(region.low, low, sizeof region.low);
    memcpy(region.high, high, sizeof region.high);
    return region;
}

GXFEM_API gx_region gx_region_sphere(const double center[3], double radius) {
    gx_region region;
    memset(&region, 0, sizeof region);
    region.kind = GX_REGION_SPHERE;
    memcpy(region.center, center, sizeof region.center);
    region.radius = radius;
    return region;
}

/* >>map: from rest to space ---------------------------------------------------------------------------------------- */
/* In: a material point, or a cell. Out: where it is, how fast its corners are. Nothing else in this file turns
   displacements of copies into positions, but for >>tree, >>locate and what follows there. Touches nothing. */

/* sum += weight A (x - X) of an affine copy; x: a material point. linear: a body's copies.linear or linear_rate */
static void gxp_add_linear(const gx_body *body, const double *linear, uint32_t copy, double weight, const double x[3],
                           double sum[3]) {
    const double *node = body->mesh.positions + 3 * (size_t)body->copies.node[copy], *a = linear + 9 * (size_t)copy;
    int k;
    for (k = 0; k < 3; k++)
        sum[k] += weight * (a[k] * (x[0] - node[0]) + a[3 + k] * (x[1] - node[1]) + a[6 + k] * (x[2] - node[2]));
}

/* Adds what affine ones of the copies that move a material point give it beside their displacements. */
static void gxp_add_bend(const gx_body *body, const uint32_t *copies, const double *weights, uint32_t count,
                         const double rest[3], double position[3]) {
    uint32_t n;
    for (n = 0; n < count; n++)
        if (body->copies.affine[copies[n]])
            gxp_add_linear(body, body->copies.linear, copies[n], weights[n], rest, position);
}

/* Is a copy of the cell affine? Then its map is quadratic. */
static int gxp_is_bent(const gx_body *body, const gxp_cell *cell) {
    int n, bent = 0;
    for (n = 0; n < 4 && body->copies.bends; n++) bent |= body->copies.affine[cell->copies[n]];
    return bent;
}

/* Where a point is: rest + sum of weight u over the copies of weight not 0, which stand first */
static inline void gxp_map_point(const gx_body *body, const double rest[3], const uint32_t *copies,
                                 const double *weights, uint32_t count, double position[3]) {
    const double *displacement = body->copies.displacement;
    double x = rest[0], y = rest[1], z = rest[2];
    uint32_t n;
    for (n = 0; n < count && weights[n] > 0; n++) {
        const double *u = displacement + 3 * (size_t)copies[n];
        x += weights[n] * u[0];
        y += weights[n] * u[1];
        z += weights[n] * u[2];
    }
    position[0] = x;
    position[1] = y;
    position[2] = z;
    if (body->copies.bends) gxp_add_bend(body, copies, weights, n, rest, position);
}

/* x of the cell's nodes from a centre, at rest or, moved, with the displacement of its copies */
static void gxp_cell_corners(const gx_body *body, const gxp_cell *cell, int moved, const double center[3],
                             double x[4][3]) {
    int n, k;
    for (n = 0; n < 4; n++) {
        const double *rest =
            body->mesh.positions + 3 * (size_t)gxb_complex_element_nodes(body->complex, cell->element)[n];
        const double *u = body->copies.displacement + 3 * (size_t)cell->copies[n];
        for (k = 0; k < 3; k++) x[n][k] = rest[k] - center[k] + (moved ? u[k] : 0);
    }
}

/* Where a copy of a node is: rest + displacement, rounded once */
static inline void gxp_copy_position(const gx_body *body, uint32_t node, uint32_t copy, double x[3]) {
    const double *rest = body->mesh.positions + 3 * (size_t)node, *u = body->copies.displacement + 3 * (size_t)copy;
    x[0] = rest[0] + u[0];
    x[1] = rest[1] + u[1];
    x[2] = rest[2] + u[2];
}

/* Where the corners of a cell's element are, as its copies move them. These doubles are what locating takes as exact.
 */
static inline void gxp_moved_corners(const gx_body *body, const gxp_cell *cell, double x[12]) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, cell->element);
    gxp_copy_position(body, node[0], cell->copies[0], x);
    gxp_copy_position(body, node[1], cell->copies[1], x + 3);
    gxp_copy_position(body, node[2], cell->copies[2], x + 6);
    gxp_copy_position(body, node[3], cell->copies[3], x + 9);
}

/* Where the cell's map has a material point: weights are its barycentric coordinates in the element */
static void gxp_map_affine(const gx_body *body, const gxp_cell *cell, const double weights[4], const double rest[3],
                           double position[3]) {
    int n, k;
    for (k = 0; k < 3; k++) {
        position[k] = rest[k];
        for (n = 0; n < 4; n++)
            position[k] += weights[n] * body->copies.displacement[3 * (size_t)cell->copies[n] + (size_t)k];
    }
    if (body->copies.bends) gxp_add_bend(body, cell->copies, weights, 4, rest, position);
}

/* The velocities of the cell's copies, less a mean */
static void gxp_cell_velocities(const gx_body *body, const gxp_cell *cell, const double mean[3], double v[4][3]) {
    int n, k;
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++) v[n][k] = body->copies.velocity[3 * (size_t)cell->copies[n] + (size_t)k] - mean[k];
}

/* >>fragments: sums, ids, changes, the view ------------------------------------------------------------------------ */
/* In: the numbering of fragments. Out: their volumes, masses, centres and inertia; ids that stay, by comparison with
   the last snapshot. Touches the view's sums, the snapshot and the copies' labels. */

/* The place of entry ij in a mass block */
static const uint8_t gxp_mass_at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

/* The sum of a row of a mass block: density * integral of lambda_i */
static double gxp_mass_row(const double mass[10], int i) {
    const uint8_t *row = gxp_mass_at[i];
    return mass[row[0]] + mass[row[1]] + mass[row[2]] + mass[row[3]];
}

/* sum += density * integral of x over the cell */
static void gxp_add_first_moment(const gxp_cell *cell, double x[4][3], double sum[3]) {
    int n, k;
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++) sum[k] += gxp_mass_row(cell->mass, n) * x[n][k];
}

/* mx_i = sum_j m_ij x_j */
static void gxp_mass_times(const gxp_cell *cell, double x[4][3], double mx[4][3]) {
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) {
            const uint8_t *row = gxp_mass_at[i];
            mx[i][k] = cell->mass[row[0]] * x[0][k] + cell->mass[row[1]] * x[1][k] + cell->mass[row[2]] * x[2][k] +
                       cell->mass[row[3]] * x[3][k];
        }
}

/* inertia += density * integral of (|x|^2 1 - x x^T) = sum_ij m_ij (x_i . x_j 1 - x_i x_j^T); mx: see gxp_mass_times */
static void gxp_add_inertia(double x[4][3], double mx[4][3], double inertia[6]) {
    int i;
    for (i = 0; i < 4; i++) {
        const double *a = mx[i], *b = x[i];
        inertia[0] += a[1] * b[1] + a[2] * b[2];
        inertia[3] += a[0] * b[0] + a[2] * b[2];
        inertia[5] += a[0] * b[0] + a[1] * b[1];
        inertia[1] -= a[0] * b[1];
        inertia[2] -= a[0] * b[2];
        inertia[4] -= a[1] * b[2];
    }
}

/* Volumes, masses, centres and inertia of fragments */
static gx_result gxp_sum_fragments(gx_body *body) {
    static const double zero[3] = {0, 0, 0};
    gxp_view *view = &body->view;
    const size_t count = view->fragment_count;
    double x[4][3], mx[4][3];
    uint32_t i, f;
    int n;
    const gx_result result = gxp_grow_rows(body, GXP_SUMS, 0);
    view->body_volume = view->body_mass = 0;
    if (result == GX_OK) view->sums_stale = 0;
    if (result != GX_OK || count == 0) return result;
    memset(view->fragment_volume, 0, count * sizeof *view->fragment_volume);
    memset(view->fragment_mass, 0, count * sizeof *view->fragment_mass);
    memset(view->fragment_center, 0, 3 * count * sizeof *view->fragment_center);
    memset(view->fragment_inertia, 0, 6 * count * sizeof *view->fragment_inertia);
    for (i = 0; i < view->count; i++) {
        const gxp_cell *cell = &body->cells.data[view->cell[i]];
        f = view->fragment[i];
        view->fragment_volume[f] += cell->volume;
        for (n = 0; n < 4; n++) view->fragment_mass[f] += gxp_mass_row(cell->mass, n);
        gxp_cell_corners(body, cell, 0, zero, x);
        gxp_add_first_moment(cell, x, view->fragment_center + 3 * (size_t)f);
    }
    for (f = 0; f < count; f++) {
        view->body_volume += view->fragment_volume[f];
        view->body_mass += view->fragment_mass[f];
        for (n = 0; n < 3; n++)
            if (view->fragment_mass[f] > 0) view->fragment_center[3 * (size_t)f + (size_t)n] /= view->fragment_mass[f];
    }
    for (i = 0; i < view->count; i++) {
        const gxp_cell *cell = &body->cells.data[view->cell[i]];
        f = view->fragment[i];
        gxp_cell_corners(body, cell, 0, view->fragment_center + 3 * (size_t)f, x);
        gxp_mass_times(cell, x, mx);
        gxp_add_inertia(x, mx, view->fragment_inertia + 6 * (size_t)f);
    }
    return GX_OK;
}

/* Unites copies by the cells around the nodes of new copies, and by no others: view.split_parents. */
static gx_result gxp_join_around_splits(gx_body *body) {
    gxp_view *view = &body->view;
    gxp_words *cells = &view->split_cells;
    uint32_t i, j, k, cell, *parent;
    gx_result result = gxp_start_words(body, &view->split_parents, body->copies.count);
    parent = view->split_parents.data;
    cells->count = 0;
    body->scratch.stamp++;
    for (i = 0; i < view->splits.count; i += 2) {
        const uint32_t node = body->copies.node[view->splits.data[i]];
        for (j = body->mesh.node_start[node]; j < body->mesh.node_start[node + 1]; j++)
            for (cell = body->mesh.node_elements[j]; cell != GXP_NONE && result == GX_OK;
                 cell = body->cells.data[cell].next)
                if (body->cells.data[cell].kept) result = gxp_visit_cell(body, cell, cells);
    }
    if (result != GX_OK) return result;
    for (i = 0; i < cells->count; i++)
        for (k = 0; k < 4; k++) {
            const uint32_t copy = body->cells.data[cells->data[i]].copies[k];
            parent[copy] = copy;
        }
    for (i = 0; i < cells->count; i++) gxp_unite_all(parent, body->cells.data[cells->data[i]].copies);
    return GX_OK;
}

/* Finds the fragment of each copy. Sheets remove nothing: if two old copies were connected, so are their descendants.
   If each new copy is still connected with the one it comes from, around its node, no fragment has fallen apart. */
static gx_result gxp_update_labels(gx_body *body) {
    gxp_view *view = &body->view;
    const gxp_words *splits = &view->splits;
    uint32_t i, *parent;
    gx_result result;
    if (!view->stale || (view->labels_known && splits->count == 0)) return GX_OK;
    if (!view->labels_known) return gxp_update_view(body);
    result = gxp_join_around_splits(body);
    parent = view->split_parents.data;
    for (i = 0; i < splits->count && result == GX_OK; i += 2)
        if (gxp_find(parent, splits->data[i]) != gxp_find(parent, splits->data[i + 1])) return gxp_update_view(body);
    if (result == GX_OK)
        result = gxp_words_room(body, &view->copy_fragment, body->copies.count - view->copy_fragment.count);
    if (result != GX_OK) return result;
    view->copy_fragment.count = body->copies.count;
    for (i = 0; i < splits->count; i += 2)
        view->copy_fragment.data[splits->data[i]] = gxp_find(view->copy_fragment.data, splits->data[i + 1]);
    view->splits.count = 0;
    return GX_OK;
}

/* Where the fragments come from, by the labels of their copies */
typedef struct gxp_change {
    uint32_t *origin;   /* by fragment: its index in the snapshot */
    uint32_t *touched;  /* by fragment: 1 if it was cut */
    uint32_t *heaviest; /* by fragment of the snapshot: the one that keeps the id; GXP_NONE: nothing is left */
    uint32_t *count;    /* by fragment of the snapshot: into how many it fell apart */
} gxp_change;

/* Labels the copies with their fragments, which are the snapshot's now. */
static void gxp_label_copies(gx_body *body) {
    uint32_t i, k;
    for (i = 0; i < body->view.count; i++)
        for (k = 0; k < 4; k++) body->copies.label[body->view.copies[4 * i + k]] = 2 * body->view.fragment[i];
}

static void gxp_find_origins(gx_body *body, gxp_change *change) {
    const gxp_view *view = &body->view;
    const double *mass = view->fragment_mass;
    uint32_t i, k, f;
    for (i = 0; i < view->count; i++)
        for (k = 0; k < 4; k++) {
            const uint32_t label = body->copies.label[view->copies[4 * i + k]];
            change->origin[view->fragment[i]] = label >> 1;
            change->touched[view->fragment[i]] |= label & 1;
        }
    for (f = 0; f < view->fragment_count; f++) {
        uint32_t *heaviest = &change->heaviest[change->origin[f]];
        if (*heaviest == GXP_NONE || mass[f] > mass[*heaviest]) *heaviest = f;
        change->count[change->origin[f]]++;
    }
}

/* Writes the ids and changes to the snapshot, which has room. */
static void gxp_give_ids(gx_body *body, const gxp_change *change) {
    gxp_snapshot *snapshot = &body->snapshot;
    const uint32_t count = body->view.fragment_count;
    uint32_t *ids = change->touched, i; /* a fragment's flag is read before its id is written */
    snapshot->removed.count = 0;
    for (i = 0; i < snapshot->count; i++)
        if (change->heaviest[i] == GXP_NONE) snapshot->removed.data[snapshot->removed.count++] = snapshot->id[i];
    for (i = 0; i < count; i++) {
        const uint32_t origin = change->origin[i];
        const int keeps = change->heaviest[origin] == i;
        snapshot->origin[i] = snapshot->id[origin];
        snapshot->change[i] = !keeps                    ? GX_FRAGMENT_CREATED
                            : change->count[origin] > 1 ? GX_FRAGMENT_SPLIT
                            : change->touched[i]        ? GX_FRAGMENT_TOUCHED
                                                        : GX_FRAGMENT_UNCHANGED;
        ids[i] = keeps ? snapshot->id[origin] : snapshot->next_id++;
    }
    snapshot->count = count;
    if (count > 0) memcpy(snapshot->id, ids, count * sizeof *ids);
}

static gx_result gxp_snapshot_room(gx_body *body) {
    gxp_snapshot *snapshot = &body->snapshot;
    gx_result result = gxp_grow_rows(body, GXP_SNAPSHOT, body->view.fragment_count);
    if (result == GX_OK) result = gxp_words_room(body, &snapshot->removed, snapshot->count);
    return result == GX_OK && snapshot->next_id > UINT32_MAX - body->view.fragment_count ? GX_ERROR_LIMIT : result;
}

/* Brings the snapshot up to date with the view. After an error labels and ids are as they were, so that no change is
   lost. */
static gx_result gxp_take_snapshot(gx_body *body) {
    const size_t now = body->view.fragment_count, before = body->snapshot.count,
                 bytes = (2 * now + 2 * before + 1) * sizeof(uint32_t);
    gxp_change change;
    gx_result result;
    if (!body->snapshot.stale) return GX_OK;
    result = gxp_snapshot_room(body);
    if (result != GX_OK) return result;
    change.origin = (uint32_t *)gxp_allocate(&body->config.allocator, bytes);
    if (change.origin == NULL) return GX_ERROR_MEMORY;
    memset(change.origin, 0, bytes);
    change.touched = change.origin + now;
    change.count = change.touched + now;
    change.heaviest = change.count + before;
    memset(change.heaviest, 0xff, before * sizeof *change.heaviest);
    gxp_find_origins(body, &change);
    gxp_give_ids(body, &change);
    gxp_release(&body->config.allocator, change.origin, bytes);
    gxp_label_copies(body);
    body->snapshot.stale = 0;
    return GX_OK;
}

/* Takes the snapshot of the mesh: ids 1, 2 ... */
static gx_result gxp_first_snapshot(gx_body *body) {
    gxp_snapshot *snapshot = &body->snapshot;
    uint32_t f;
    gx_result result = gxp_update_view(body);
    snapshot->next_id = 1;
    if (result == GX_OK) result = gxp_snapshot_room(body);
    if (result != GX_OK) return result;
    for (f = 0; f < body->view.fragment_count; f++) {
        snapshot->id[f] = snapshot->origin[f] = snapshot->next_id++;
        snapshot->change[f] = GX_FRAGMENT_UNCHANGED;
    }
    snapshot->count = body->view.fragment_count;
    gxp_label_copies(body);
    return GX_OK;
}

GXFEM_API gx_result gx_body_view(gx_body *body, gx_view *view, gx_failure *failure) {
    const gxp_view *own;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (view == NULL) return gxp_refuse(failure, "view");
    result = gxp_update_view(body);
    if (result == GX_OK && body->view.sums_stale) result = gxp_sum_fragments(body);
    if (result == GX_OK) result = gxp_find_held(body);
    if (result == GX_OK) result = gxp_take_snapshot(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    gxp_flag_held(body);
    own = &body->view;
    view->node_count = body->mesh.node_count;
    view->element_count = body->mesh.element_count;
    view->cell_count = own->count;
    view->cell_element = own->element;
    view->cell_copies = own->copies;
    view->cell_volume = own->volume;
    view->cell_fragment = own->fragment;
    view->cell_slot = own->slot;
    view->slot_count = body->slots.count;
    view->slot_parent = body->slots.parent;
    view->copy_count = body->copies.count;
    view->copy_node = body->copies.node;
    view->copy_held = body->copies.held;
    view->copy_region = body->holds.region_of.data;
    view->epoch = body->cuts.epoch;
    view->displacement = body->copies.displacement;
    view->velocity = body->copies.velocity;
    view->rest_time = body->copies.rest_time;
    view->fragment_count = own->fragment_count;
    view->fragment_volume = own->fragment_volume;
    view->fragment_mass = own->fragment_mass;
    view->fragment_center = own->fragment_center;
    view->fragment_inertia = own->fragment_inertia;
    view->fragment_id = body->snapshot.id;
    view->fragment_origin = body->snapshot.origin;
    view->fragment_change = body->snapshot.change;
    view->removed_count = body->snapshot.removed.count;
    view->removed_ids = body->snapshot.removed.data;
    view->volume = own->body_volume;
    view->mass = own->body_mass;
    view->copy_affine = body->copies.affine;
    view->affine = body->copies.linear;
    view->affine_rate = body->copies.linear_rate;
    view->positions = body->mesh.positions;
    view->elements = gxb_complex_element_nodes(body->complex, 0);
    view->cell_material = own->material;
    return GX_OK;
}

/* >>motion: momentum and energy of fragments ----------------------------------------------------------------------- */
/* In: displacement and velocity. Out: the motion of each fragment. Touches nothing but the view's lists. */

/* A principal moment below this share of the largest is rounding: nothing turns about its axis. */
#define GXP_NO_INERTIA 1e-13

/* One rotation of Jacobi's method: makes entry pq of the symmetric matrix a zero; the columns of v are its axes. */
static void gxp_rotate(double a[3][3], double v[3][3], int p, int q) {
    double t, c, s;
    int k;
    if (!(fabs(a[p][q]) > 0)) return;
    t = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    t = (t < 0 ? -1 : 1) / (fabs(t) + sqrt(t * t + 1));
    c = 1 / sqrt(t * t + 1);
    s = t * c;
    for (k = 0; k < 3; k++) {
        const double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (k = 0; k < 3; k++) {
        const double x = a[p][k], y = a[q][k], z = v[k][p], w = v[k][q];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        v[k][p] = c * z - s * w;
        v[k][q] = s * z + c * w;
    }
    a[p][q] = a[q][p] = 0;
}

/* spin = pseudo-inverse of the inertia times the angular momentum */
static void gxp_spin(const double inertia[6], const double momentum[3], double spin[3]) {
    double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, largest = 0;
    int i, k, sweep;
    a[0][0] = inertia[0];
    a[1][1] = inertia[3];
    a[2][2] = inertia[5];
    a[0][1] = a[1][0] = inertia[1];
    a[0][2] = a[2][0] = inertia[2];
    a[1][2] = a[2][1] = inertia[4];
    for (sweep = 0; sweep < 8; sweep++) { /* converges quadratically: 5 are enough */
        gxp_rotate(a, v, 0, 1);
        gxp_rotate(a, v, 0, 2);
        gxp_rotate(a, v, 1, 2);
    }
    for (i = 0; i < 3; i++)
        if (a[i][i] > largest) largest = a[i][i];
    spin[0] = spin[1] = spin[2] = 0;
    for (i = 0; i < 3; i++) {
        const double along = v[0][i] * momentum[0] + v[1][i] * momentum[1] + v[2][i] * momentum[2];
        for (k = 0; k < 3 && a[i][i] > GXP_NO_INERTIA * largest; k++) spin[k] += along / a[i][i] * v[k][i];
    }
}

/* Adds to inertia, angular momentum (sum_ij m_ij x_i x v_j) and energy; x and v are relative to the centre. */
static void gxp_add_rotation(const gxp_cell *cell, double x[4][3], double v[4][3], gx_motion *motion,
                             double momentum[3]) {
    double mx[4][3], mv[4][3];
    int i, k;
    gxp_mass_times(cell, x, mx);
    gxp_mass_times(cell, v, mv);
    gxp_add_inertia(x, mx, motion->inertia);
    for (i = 0; i < 4; i++)
        for (k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            momentum[k] += mx[i][a] * v[i][b] - mx[i][b] * v[i][a];
            motion->energy += 0.5 * mv[i][k] * v[i][k];
        }
}

/* Four points of a cell and their shares of the copies, which integrate all quadratics over the cell with a quarter of
   its mass each: c + L (1,1,1), (1,-1,-1), (-1,1,-1), (-1,-1,1), with c its centre and L L^T its covariance, in
   barycentric coordinates. */
static void gxp_four_points(const double mass[10], double whole, double share[4][4]) {
    static const int sign[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double root[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, center[4];
    int i, j, k;
    for (i = 0; i < 4; i++) center[i] = gxp_mass_row(mass, i) / whole;
    for (i = 0; i < 3; i++)
        for (j = 0; j <= i; j++) {
            double sum = mass[gxp_mass_at[i + 1][j + 1]] / whole - center[i + 1] * center[j + 1];
            for (k = 0; k < j; k++) sum -= root[i][k] * root[j][k];
            if (i == j)
                root[i][i] = sum > 0 ? sqrt(sum) : 0;
            else
                root[i][j] = root[j][j] > 0 ? sum / root[j][j] : 0;
        }
    for (k = 0; k < 4; k++) {
        share[k][0] = 1;
        for (i = 1; i < 4; i++) {
            share[k][i] = center[i];
            for (j = 0; j < i; j++) share[k][i] += sign[k][j] * root[i - 1][j];
            share[k][0] -= share[k][i];
        }
    }
}

/* What moves in a cell: its mass block and its corners, x from a centre, v less a mean. In a cell with affine copies,
   four points as heavy as each other take the corners' places: then all sums over the block are those of the rule by
   which the solver integrates. Centre and momentum are exact. */
static void gxp_moving_cell(const gx_body *body, const gxp_cell *cell, const double center[3], const double mean[3],
                            gxp_cell *block, double x[4][3], double v[4][3]) {
    const gxp_copies *copies = &body->copies;
    double rest[12], share[4][4], whole = 0;
    int i, k, n;
    memcpy(block->mass, cell->mass, sizeof block->mass);
    for (n = 0; n < 4; n++) whole += gxp_mass_row(cell->mass, n);
    if (!(whole > 0) || !gxp_is_bent(body, cell)) {
        gxp_cell_corners(body, cell, 1, center, x);
        gxp_cell_velocities(body, cell, mean, v);
        return;
    }
    gxp_four_points(cell->mass, whole, share);
    gxp_element_positions(body, cell->element, rest);
    memset(block->mass, 0, sizeof block->mass);
    for (i = 0; i < 4; i++) {
        double point[3] = {0, 0, 0};
        block->mass[gxp_mass_at[i][i]] = whole / 4;
        for (k = 0; k < 3; k++) {
            x[i][k] = -center[k];
            v[i][k] = -mean[k];
            for (n = 0; n < 4; n++) {
                const size_t at = 3 * (size_t)cell->copies[n] + (size_t)k;
                point[k] += share[i][n] * rest[3 * n + k];
                x[i][k] += share[i][n] * (rest[3 * n + k] + copies->displacement[at]);
                v[i][k] += share[i][n] * copies->velocity[at];
            }
        }
        for (n = 0; n < 4; n++) {
            gxp_add_linear(body, copies->linear, cell->copies[n], share[i][n], point, x[i]);
            gxp_add_linear(body, copies->linear_rate, cell->copies[n], share[i][n], point, v[i]);
        }
    }
}

/* Mass, centre and velocity of all fragments */
static void gxp_find_centers(const gx_body *body, gx_motion *motions) {
    const gxp_view *view = &body->view;
    static const double zero[3] = {0, 0, 0};
    uint32_t i;
    int k;
    memset(motions, 0, view->fragment_count * sizeof *motions);
    for (i = 0; i < view->count; i++) {
        const gxp_cell *cell = &body->cells.data[view->cell[i]];
        gx_motion *motion = &motions[view->fragment[i]];
        double x[4][3], v[4][3];
        gxp_cell block;
        gxp_moving_cell(body, cell, zero, zero, &block, x, v);
        for (k = 0; k < 4; k++) motion->mass += gxp_mass_row(cell->mass, k);
        gxp_add_first_moment(&block, x, motion->center);
        gxp_add_first_moment(&block, v, motion->velocity);
    }
    for (i = 0; i < view->fragment_count; i++)
        for (k = 0; k < 3 && motions[i].mass > 0; k++) {
            motions[i].center[k] /= motions[i].mass;
            motions[i].velocity[k] /= motions[i].mass;
        }
}

/* If a motion is not finite, is it the state (NOT_FINITE), or only beyond doubles (RANGE)? */
static gx_result gxp_check_motion(const gx_body *body, const gx_motion *motion, gx_failure *failure) {
    double number[17];
    size_t i;
    int finite = 1;
    memcpy(number, &motion->mass, sizeof *number);
    memcpy(number + 1, motion->center, 3 * sizeof *number);
    memcpy(number + 4, motion->inertia, 6 * sizeof *number);
    memcpy(number + 10, motion->velocity, 3 * sizeof *number);
    memcpy(number + 13, motion->angular_velocity, 3 * sizeof *number);
    memcpy(number + 16, &motion->energy, sizeof *number);
    for (i = 0; i < 17; i++) finite = finite && gxp_is_finite(number[i]);
    if (finite) return GX_OK;
    for (i = 0; i < 3 * (size_t)body->copies.count; i++) {
        if (!gxp_is_finite(body->copies.displacement[i]))
            return gxp_fail(failure, GX_ERROR_NOT_FINITE, "displacement", i / 3);
        if (!gxp_is_finite(body->copies.velocity[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "velocity", i / 3);
    }
    return gxp_end(failure, GX_ERROR_RANGE);
}

GXFEM_API gx_result gx_body_motion(gx_body *body, gx_motion *motions, size_t capacity, gx_failure *failure) {
    double(*momentum)[3];
    size_t bytes;
    uint32_t i;
    int k;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (motions == NULL && capacity > 0) return gxp_refuse(failure, "motions");
    result = gxp_update_view(body);
    if (gxp_end(failure, result) != GX_OK || body->view.fragment_count == 0) return result;
    if (capacity < body->view.fragment_count) return gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    bytes = body->view.fragment_count * sizeof *momentum;
    momentum = (double(*)[3])gxp_allocate(&body->config.allocator, bytes);
    if (momentum == NULL) return gxp_end(failure, GX_ERROR_MEMORY);
    memset(momentum, 0, bytes);
    gxp_find_centers(body, motions);
    for (i = 0; i < body->view.count; i++) {
        const gxp_cell *cell = &body->cells.data[body->view.cell[i]];
        const uint32_t f = body->view.fragment[i];
        double x[4][3], v[4][3];
        gxp_cell block;
        gxp_moving_cell(body, cell, motions[f].center, motions[f].velocity, &block, x, v);
        gxp_add_rotation(&block, x, v, &motions[f], momentum[f]);
    }
    for (i = 0; i < body->view.fragment_count; i++) {
        gxp_spin(motions[i].inertia, momentum[i], motions[i].angular_velocity);
        for (k = 0; k < 3; k++)
            motions[i].energy += 0.5 * motions[i].mass * motions[i].velocity[k] * motions[i].velocity[k];
        if (result == GX_OK) result = gxp_check_motion(body, &motions[i], failure);
    }
    gxp_release(&body->config.allocator, momentum, bytes);
    return result;
}

/* >>attached: anchors and regions of a step ------------------------------------------------------------------------ */
/* In: anchors, and what a step has at them; poses of regions. Out: springs, contact points, forces and targets by
   copies, as the solver takes them. Touches working memory of a step only. */

/* The number of vectors of the solver's model: copies, and three hidden ones for each that is affine there */
static size_t gxp_vector_count(const gx_body *body) {
    return (size_t)body->copies.count + 3 * (size_t)body->hidden.copies.count;
}

/* Room for a point's span with hidden vectors; 0: the point stays as it is, or the solver refuses it. */
static size_t gxp_span_room(const gxs_point *point) {
    const int whole =
        point->copies != NULL ? point->weights != NULL : point->weights == NULL && point->count <= GXS_POINT_OWN;
    return whole && point->count <= GXS_POINT_MOST ? 4 * (size_t)point->count : 0;
}

/* Writes the point's span with the hidden vectors of its affine copies, whose weights are N_i (x - X_i) over
   affine_length: then the point is moved by the sum of N_i (a_i + A_i (x - X_i)). copies, weights: room for
   gxp_span_room, which is not 0. The point refers to them, unless none of its copies is affine. */
static void gxp_expand_point(const gx_body *body, gxs_point *point, uint32_t *copies, double *weights) {
    const uint32_t *from = point->copies != NULL ? point->copies : point->copy, *first = body->hidden.first.data;
    const double *weight = point->copies != NULL ? point->weights : point->weight;
    uint32_t i, count = 0;
    int k, affine = 0;
    if (body->hidden.copies.count == 0 || point->epoch != body->cuts.epoch) return;
    for (i = 0; i < point->count; i++) affine |= from[i] >= body->copies.count || first[from[i]] != GXS_NOT_AFFINE;
    if (!affine) return;
    for (i = 0; i < point->count; i++) { /* a hidden vector is no copy: the solver refuses what is beyond them */
        copies[i] = from[i] < body->copies.count ? from[i] : UINT32_MAX;
        weights[i] = weight[i];
    }
    for (i = 0, count = point->count; i < point->count; i++) {
        const double *x = body->mesh.positions;
        if (copies[i] == UINT32_MAX || first[copies[i]] == GXS_NOT_AFFINE) continue;
        x += 3 * (size_t)body->copies.node[copies[i]];
        for (k = 0; k < 3; k++) {
            copies[count] = first[copies[i]] + (uint32_t)k;
            weights[count++] = weights[i] * (point->position[k] - x[k]) / body->mesh.affine_length;
        }
    }
    point->copies = copies;
    point->weights = weights;
    point->count = count;
}

/* The same with the next place in the spans of a step; there is room. */
static void gxp_expand_next(gx_body *body, gxs_point *point) {
    gxp_words *copies = &body->hidden.span_copies;
    const size_t room = gxp_span_room(point);
    if (room == 0) return;
    gxp_expand_point(body, point, copies->data + copies->count, body->hidden.span_weights + copies->count);
    copies->count += (uint32_t)room;
}

/* The copies that move an anchor, which was checked. Returns 0 if its material is gone: the point then names a copy
   with a weight of 0, so that nothing moves it and it pulls at nothing. */
static int gxp_place_anchor(gx_body *body, const gx_anchor *anchor, gxs_point *point) {
    const uint32_t cell = gxp_anchor_cell(body, anchor);
    double weight[4];
    int k;
    memset(point, 0, sizeof *point);
    memcpy(point->position, anchor->position, sizeof point->position);
    point->epoch = body->cuts.epoch;
    if (cell == GXP_NONE) {
        point->count = 1;
        return 0;
    }
    gxp_element_weights(body, anchor->element, anchor->position, weight);
    for (k = 0; k < 4; k++) {
        if (!(weight[k] > 0)) continue;
        point->copy[point->count] = body->cells.data[cell].copies[k];
        point->weight[point->count++] = weight[k];
    }
    return 1;
}

GXFEM_API gx_result gx_body_anchor_point(gx_body *body, const gx_anchor *anchor, gxs_point *point, double position[3],
                                         gx_failure *failure) {
    static const char *const names[3] = {"anchor.element", "anchor.position", "anchor.toward"};
    gxs_point own;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (anchor == NULL) return gxp_refuse(failure, "anchor");
    result = gxp_check_anchor(body, anchor, names, SIZE_MAX, failure);
    if (result != GX_OK) return result;
    if (!gxp_place_anchor(body, anchor, &own)) return gxp_fail(failure, GX_ERROR_EMPTY, "anchor", SIZE_MAX);
    if (position != NULL) gxp_map_point(body, own.position, own.copy, own.weight, own.count, position);
    if (point != NULL) *point = own;
    return gxp_end(failure, GX_OK);
}

GXFEM_API gx_result gx_body_lost_anchors(gx_body *body, const gx_anchor *anchors, size_t count, uint8_t *lost,
                                         gx_failure *failure) {
    static const char *const names[3] = {"anchors.element", "anchors.position", "anchors.toward"};
    gx_result result = GX_OK;
    size_t i;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (anchors == NULL && count > 0) return gxp_refuse(failure, "anchors");
    if (lost == NULL && count > 0) return gxp_refuse(failure, "lost");
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxp_check_anchor(body, &anchors[i], names, i, failure);
        if (result == GX_OK) lost[i] = gxp_anchor_cell(body, &anchors[i]) == GXP_NONE;
    }
    return result == GX_OK ? gxp_end(failure, GX_OK) : result;
}

/* Room for `count` items of a step; blames the count if there are too many. */
static gx_result gxp_attached_room(gx_body *body, void *array, size_t size, uint32_t *capacity, size_t count,
                                   const char *field, gx_failure *failure) {
    const gx_result result =
        count > INT32_MAX ? GX_ERROR_LIMIT : gxp_reserve(&body->config.allocator, array, size, 0, capacity, count);
    return result == GX_ERROR_LIMIT ? gxp_fail(failure, result, field, SIZE_MAX) : gxp_end(failure, result);
}

static gx_result gxp_attach_springs(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    static const char *const names[3] = {"spring_anchors.element", "spring_anchors.position", "spring_anchors.toward"};
    gxp_attached *attached = &body->attached;
    gx_result result;
    size_t i;
    if (desc->spring_anchors == NULL || desc->springs == NULL) return GX_OK;
    result = gxp_attached_room(body, &attached->springs, sizeof *attached->springs, &attached->spring_capacity,
                               desc->spring_count, "spring_count", failure);
    for (i = 0; i < desc->spring_count && result == GX_OK; i++) {
        gxs_spring *spring = &attached->springs[i];
        *spring = desc->springs[i];
        result = gxp_check_anchor(body, &desc->spring_anchors[i], names, i, failure);
        if (result == GX_OK && !gxp_place_anchor(body, &desc->spring_anchors[i], &spring->point) &&
            gxp_is_finite(spring->stiffness) && spring->stiffness > 0)
            spring->stiffness = 0;
    }
    step->springs = attached->springs;
    return result;
}

static gx_result gxp_attach_points(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    static const char *const names[3] = {"point_anchors.element", "point_anchors.position", "point_anchors.toward"};
    gxp_attached *attached = &body->attached;
    gx_result result;
    size_t i;
    if (desc->point_anchors == NULL) return GX_OK;
    result = gxp_attached_room(body, &attached->points, sizeof *attached->points, &attached->point_capacity,
                               desc->point_count, "point_count", failure);
    for (i = 0; i < desc->point_count && result == GX_OK; i++) {
        result = gxp_check_anchor(body, &desc->point_anchors[i], names, i, failure);
        if (result == GX_OK) (void)gxp_place_anchor(body, &desc->point_anchors[i], &attached->points[i]);
    }
    step->points = attached->points;
    return result;
}

/* Vectors of one side of a pair with anchors at most */
static size_t gxp_side_room(const gx_body *body) { return body->hidden.copies.count > 0 ? 16 : 4; }

/* The point of a pair: anchor's position relative to that of other. copies, weights: room for two sides, used by the
   point. Returns 0 if the material of one is gone. */
static int gxp_place_pair(gx_body *body, const gx_anchor *anchor, const gx_anchor *other, uint32_t *copies,
                          double *weights, gxs_point *point) {
    gxs_point side[2];
    const int there = gxp_place_anchor(body, anchor, &side[0]), beside = gxp_place_anchor(body, other, &side[1]);
    uint32_t k;
    int i;
    *point = side[0];
    if (!there || !beside) { /* of weight 0: it pulls at nothing */
        memset(point->weight, 0, sizeof point->weight);
        return 0;
    }
    point->count = 0;
    for (i = 0; i < 2; i++) {
        uint32_t *own = copies + point->count;
        double *share = weights + point->count;
        memcpy(own, side[i].copy, sizeof side[i].copy);
        memcpy(share, side[i].weight, sizeof side[i].weight);
        gxp_expand_point(body, &side[i], own, share);
        for (k = 0; k < side[i].count && i == 1; k++) share[k] = -share[k];
        point->count += side[i].count;
    }
    for (i = 0; i < 3; i++) point->position[i] -= side[1].position[i];
    point->copies = copies;
    point->weights = weights;
    return 1;
}

static gx_result gxp_attach_pairs(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    static const char *const names[3] = {"pair_anchors.element", "pair_anchors.position", "pair_anchors.toward"};
    gxp_attached *attached = &body->attached;
    const size_t span = 2 * gxp_side_room(body);
    gx_result result;
    size_t i;
    if (desc->pair_count > 0 && desc->pair_anchors == NULL && body->hidden.copies.count > 0)
        return gxp_refuse(failure, "pairs"); /* where its two sides are is not known */
    if (desc->pair_anchors == NULL || desc->pairs == NULL) return GX_OK;
    result = gxp_attached_room(body, &attached->pairs, sizeof *attached->pairs, &attached->pair_capacity,
                               desc->pair_count, "pair_count", failure);
    if (result == GX_OK)
        result = gxp_attached_room(body, &attached->sides.data, sizeof(uint32_t), &attached->sides.capacity,
                                   span * desc->pair_count, "pair_count", failure);
    if (result == GX_OK)
        result = gxp_attached_room(body, &attached->weights, sizeof(double), &attached->weight_capacity,
                                   span * desc->pair_count, "pair_count", failure);
    for (i = 0; i < desc->pair_count && result == GX_OK; i++) {
        const gx_anchor *anchor = &desc->pair_anchors[2 * i];
        gxs_pair *pair = &attached->pairs[i];
        *pair = desc->pairs[i];
        result = gxp_check_anchor(body, anchor, names, 2 * i, failure);
        if (result == GX_OK) result = gxp_check_anchor(body, anchor + 1, names, 2 * i + 1, failure);
        if (result == GX_OK &&
            !gxp_place_pair(body, anchor, anchor + 1, attached->sides.data + span * i, attached->weights + span * i,
                            &pair->point) &&
            gxp_is_finite(pair->stiffness) && pair->stiffness > 0)
            pair->stiffness = 0;
    }
    step->pairs = attached->pairs;
    return result;
}

static gx_result gxp_check_forces(const gx_body *body, const gx_step_desc *desc, gx_failure *failure) {
    static const char *const names[3] = {"force_anchors.element", "force_anchors.position", "force_anchors.toward"};
    gx_result result = GX_OK;
    size_t i;
    int k;
    if (desc->force_anchors == NULL) return gxp_refuse(failure, "force_anchors");
    if (desc->anchor_forces == NULL) return gxp_refuse(failure, "anchor_forces");
    for (i = 0; i < desc->force_count && result == GX_OK; i++) {
        result = gxp_check_anchor(body, &desc->force_anchors[i], names, i, failure);
        for (k = 0; k < 3 && result == GX_OK; k++)
            if (!gxp_is_finite(desc->anchor_forces[3 * i + (size_t)k]))
                result = gxp_fail(failure, GX_ERROR_NOT_FINITE, "anchor_forces", i);
    }
    return result;
}

/* Adds the forces at anchors to those of copies. */
static gx_result gxp_attach_forces(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    gxp_attached *attached = &body->attached;
    const size_t count = 3 * (size_t)body->copies.count;
    uint32_t copies[4 * GXS_POINT_OWN];
    double weights[4 * GXS_POINT_OWN];
    gxs_point point;
    gx_result result;
    size_t i;
    uint32_t j;
    int k;
    if (desc->force_count == 0) return GX_OK;
    result = gxp_check_forces(body, desc, failure);
    if (result != GX_OK) return result;
    result = gxp_reserve(&body->config.allocator, &attached->forces, 3 * sizeof(double), 0, &attached->force_capacity,
                         gxp_vector_count(body) + 1);
    if (gxp_end(failure, result) != GX_OK) return result;
    for (i = 0; i < count; i++) attached->forces[i] = desc->forces != NULL ? desc->forces[i] : 0;
    for (; i < 3 * gxp_vector_count(body); i++) attached->forces[i] = 0;
    for (i = 0; i < desc->force_count; i++) {
        if (!gxp_place_anchor(body, &desc->force_anchors[i], &point)) continue;
        gxp_expand_point(body, &point, copies, weights);
        for (j = 0; j < point.count; j++)
            for (k = 0; k < 3; k++)
                attached->forces[3 * (size_t)(point.copies != NULL ? copies[j] : point.copy[j]) + (size_t)k] +=
                    (point.copies != NULL ? weights[j] : point.weight[j]) * desc->anchor_forces[3 * i + (size_t)k];
    }
    step->forces = attached->forces;
    return GX_OK;
}

/* Is the pose twelve zeros? */
static int gxp_is_no_pose(const double pose[12]) {
    int i;
    for (i = 0; i < 12; i++)
        if (pose[i] < 0 || pose[i] > 0) return 0;
    return 1;
}

/* The displacement of a held copy at the step's end */
static void gxp_pose_copy(const gx_body *body, const gx_step_desc *desc, uint32_t copy, double target[3]) {
    const double *pose = desc->region_poses + 12 * (size_t)body->holds.region_of.data[copy];
    const double *x = body->mesh.positions + 3 * (size_t)body->copies.node[copy];
    const double *other = desc->targets != NULL ? desc->targets : body->copies.displacement;
    int k;
    if (gxp_is_no_pose(pose)) {
        memcpy(target, other + 3 * (size_t)copy, 3 * sizeof *target);
        return;
    }
    for (k = 0; k < 3; k++) {
        const double *row = pose + 4 * k;
        target[k] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3] - x[k];
    }
}

/* The targets of what regions hold. Held copies are up to date. */
static gx_result gxp_attach_poses(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    gxp_attached *attached = &body->attached;
    gx_result result;
    size_t i;
    uint32_t c;
    if (desc->region_poses == NULL) return GX_OK;
    for (i = 0; i < 12 * (size_t)body->holds.count; i++)
        if (!gxp_is_finite(desc->region_poses[i]))
            return gxp_fail(failure, GX_ERROR_NOT_FINITE, "region_poses", i / 12);
    result = gxp_reserve(&body->config.allocator, &attached->targets, 3 * sizeof(double), 0, &attached->target_capacity,
                         gxp_vector_count(body) + 1);
    if (gxp_end(failure, result) != GX_OK) return result;
    memset(attached->targets, 0, 3 * (size_t)body->copies.count * sizeof *attached->targets);
    for (c = 0; c < body->copies.count; c++)
        if (body->copies.held[c]) gxp_pose_copy(body, desc, c, attached->targets + 3 * (size_t)c);
    step->targets = attached->targets;
    return GX_OK;
}

/* Rewrites the spans of the step's points so that they include the hidden vectors of affine copies. */
static gx_result gxp_expand_points(gx_body *body, gxs_step_desc *step) {
    gxp_attached *attached = &body->attached;
    gxp_hidden *hidden = &body->hidden;
    const size_t springs = step->spring_count, points = step->point_count;
    size_t room = 0, i;
    gx_result result = GX_OK;
    if (springs > INT32_MAX || points > INT32_MAX) return GX_OK; /* the solver refuses these */
    for (i = 0; i < springs && step->springs != NULL; i++) room += gxp_span_room(&step->springs[i].point);
    for (i = 0; i < points && step->points != NULL; i++) room += gxp_span_room(&step->points[i]);
    result = gxp_start_words(body, &hidden->span_copies, room);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &hidden->span_weights, sizeof(double), 0, &hidden->span_capacity,
                             room);
    if (result == GX_OK && step->springs != NULL && step->springs != attached->springs)
        result = gxp_reserve(&body->config.allocator, &attached->springs, sizeof *attached->springs, 0,
                             &attached->spring_capacity, springs);
    if (result == GX_OK && step->points != NULL && step->points != attached->points)
        result = gxp_reserve(&body->config.allocator, &attached->points, sizeof *attached->points, 0,
                             &attached->point_capacity, points);
    if (result != GX_OK) return result;
    for (i = 0; i < springs && step->springs != NULL; i++) {
        if (step->springs != attached->springs) attached->springs[i] = step->springs[i];
        gxp_expand_next(body, &attached->springs[i].point);
    }
    for (i = 0; i < points && step->points != NULL; i++) {
        if (step->points != attached->points) attached->points[i] = step->points[i];
        gxp_expand_next(body, &attached->points[i]);
    }
    if (step->springs != NULL) step->springs = attached->springs;
    if (step->points != NULL) step->points = attached->points;
    return GX_OK;
}

/* Forces and targets by vector of the model. Nothing pushes hidden vectors but forces at anchors; those of held copies
   go where a pose has them, or stay. */
static gx_result gxp_expand_arrays(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step) {
    gxp_attached *attached = &body->attached;
    const size_t n = body->copies.count, vectors = gxp_vector_count(body);
    gx_result result = GX_OK;
    size_t i;
    int k;
    if (step->forces != NULL && step->forces != attached->forces) {
        result = gxp_reserve(&body->config.allocator, &attached->forces, 3 * sizeof(double), 0,
                             &attached->force_capacity, vectors);
        if (result != GX_OK) return result;
        memcpy(attached->forces, step->forces, 3 * n * sizeof(double));
        memset(attached->forces + 3 * n, 0, 3 * (vectors - n) * sizeof(double));
        step->forces = attached->forces;
    }
    if (step->targets == NULL) return GX_OK;
    if (step->targets != attached->targets) {
        result = gxp_reserve(&body->config.allocator, &attached->targets, 3 * sizeof(double), 0,
                             &attached->target_capacity, vectors);
        if (result != GX_OK) return result;
        memcpy(attached->targets, step->targets, 3 * n * sizeof(double));
        step->targets = attached->targets;
    }
    for (i = 0; i < body->hidden.copies.count; i++) {
        const uint32_t copy = body->hidden.copies.data[i];
        const double *pose = desc->region_poses != NULL && body->copies.held[copy]
                               ? desc->region_poses + 12 * (size_t)body->holds.region_of.data[copy]
                               : NULL;
        double *to = attached->targets + 3 * (n + 3 * i);
        for (k = 0; k < 9; k++)
            to[k] = body->mesh.affine_length * (pose != NULL && !gxp_is_no_pose(pose)
                                                    ? pose[4 * (k % 3) + k / 3] - (k % 3 == k / 3)
                                                    : body->copies.linear[9 * (size_t)copy + (size_t)k]);
    }
    return GX_OK;
}

/* What the step has, for a model with hidden vectors. Arrays of another numbering are not read: the solver refuses
   them. */
static gx_result gxp_expand(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step) {
    const gx_result result = gxp_expand_points(body, step);
    if (result != GX_OK || step->epoch != body->cuts.epoch) return result;
    return gxp_expand_arrays(body, desc, step);
}

/* Arrays by copy are read only if they have the present numbering. */
static gx_result gxp_attach(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step, gx_failure *failure) {
    gx_result result = gxp_attach_springs(body, desc, step, failure);
    if (result == GX_OK) result = gxp_attach_points(body, desc, step, failure);
    if (result == GX_OK) result = gxp_attach_pairs(body, desc, step, failure);
    if (result != GX_OK || (desc->force_count == 0 && desc->region_poses == NULL)) return result;
    if ((desc->forces != NULL || desc->targets != NULL) && desc->epoch != body->cuts.epoch)
        return gxp_fail(failure, GX_ERROR_STALE, "epoch", SIZE_MAX);
    step->epoch = body->cuts.epoch;
    result = gxp_attach_forces(body, desc, step, failure);
    return result == GX_OK ? gxp_attach_poses(body, desc, step, failure) : result;
}

/* >>supports: copies that only slivers carry follow others (RXFEM Eq. 22) ------------------------------------------ */
/* In: the elements with a small part. Out: constraints by which copies that next to nothing holds follow others.
   Touches the list of thin elements and the model's constraints.
   A part is the cells of an element that the same four copies move; its share is its volume over the element's. A copy
   is weak if every part around it has a share below follow_below: so little moves it that nothing else would keep it
   from running away. It takes the increment of the field of a strong cell near it, that is, one without weak copies. A
   fragment without a strong cell is thin everywhere. Its copies are then weak by comparison with its fullest part; if
   that part has a share below speck_below, or no cell reaches speck_reach, the fragment is a speck and moves as a
   point. All work is around thin elements, which are those with a part of so small a share. */

enum { GXP_FREE, GXP_FOLLOWS, GXP_FOLLOWS_POINT };

typedef struct gxp_supports {
    uint8_t *weak; /* copy_count: GXP_FREE or how it follows */
    /* copy_count: the cell whose field the copy follows, or whose first copy if it is part of a point; GXP_NONE: not
     * known, or none */
    uint32_t *cell;
    uint32_t *queue; /* copy_count: copies that the search has met, in order */
    uint32_t *seen;  /* copy_count: the last search that has met the copy */
    uint32_t search;
} gxp_supports;

/* The share of the part that the cell belongs to */
static double gxp_part_share(const gx_body *body, uint32_t cell) {
    const gxp_cell *part = &body->cells.data[cell];
    double volume = 0;
    for (cell = part->element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        if (body->cells.data[cell].kept &&
            memcmp(body->cells.data[cell].copies, part->copies, sizeof part->copies) == 0)
            volume += body->cells.data[cell].volume;
    return volume / gxp_element_volume(body, part->element);
}

/* Has the element a part with a share below follow_below? */
static int gxp_is_thin(const gx_body *body, uint32_t element) {
    uint32_t cell;
    for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        if (body->cells.data[cell].kept && gxp_part_share(body, cell) < body->config.follow_below) return 1;
    return 0;
}

/* Brings the list of thin elements up to date, over all elements or over those that have changed. */
static gx_result gxp_list_thin(gx_body *body, int anew) {
    gxp_model *model = &body->model;
    const uint32_t looked_at = anew ? body->mesh.element_count : model->changed.count;
    gx_result result = GX_OK;
    uint32_t i, k, count = 0;
    for (i = k = 0; i < model->thin.count && !anew; i++) {
        while (k < model->changed.count && model->changed.data[k] < model->thin.data[i]) k++;
        if (k == model->changed.count || model->changed.data[k] != model->thin.data[i])
            model->thin.data[count++] = model->thin.data[i];
    }
    model->thin.count = count;
    for (i = 0; i < looked_at && result == GX_OK; i++) {
        const uint32_t element = anew ? i : model->changed.data[i];
        if (gxp_is_thin(body, element)) result = gxp_push(body, &model->thin, element);
    }
    gxp_sort_unique(&model->thin);
    if (result != GX_OK) model->state = GXP_MODEL_STALE; /* the list is incomplete */
    return result;
}

/* Do all parts around the copy have a smaller share? */
static int gxp_is_weak(const gx_body *body, uint32_t copy, double share) {
    gxp_around around = gxp_around_copy(body, copy);
    while (gxp_next_around(body, &around))
        if (gxp_part_share(body, around.cell) >= share) return 0;
    return 1;
}

static int gxp_is_strong(const gx_body *body, const gxp_supports *supports, uint32_t cell) {
    const uint32_t *copies = body->cells.data[cell].copies;
    return !(supports->weak[copies[0]] | supports->weak[copies[1]] | supports->weak[copies[2]] |
             supports->weak[copies[3]]);
}

/* The weights by which a copy follows the field of a cell at its node; their sum is 1. Returns the sum of their
   absolute values: 1 within the element, more outside. */
static double gxp_follow_weights(const gx_body *body, uint32_t copy, uint32_t cell, double weight[4]) {
    const double *position = body->mesh.positions + 3 * (size_t)body->copies.node[copy];
    double x[12], gradients[12];
    int k, c;
    gxp_element_positions(body, body->cells.data[cell].element, x);
    (void)gxi_tet_gradients(x, gradients, NULL);
    for (k = 1; k < 4; k++)
        for (c = 0, weight[k] = 0; c < 3; c++) weight[k] += gradients[3 * k + c] * (position[c] - x[c]);
    weight[0] = 1 - weight[1] - weight[2] - weight[3];
    return fabs(weight[0]) + fabs(weight[1]) + fabs(weight[2]) + fabs(weight[3]);
}

/* Finds the strong cell that a weak copy follows. It searches from cell to cell. Among the nearest strong cells it
   takes the one whose field is extended least; if a copy as near already follows one, it takes that. Weak copies that
   the search met before its last round follow the same cell. Returns 0, or, if the fragment has no strong
   cell, the number of its copies, all of which the search has met. */
static uint32_t gxp_find_cell(const gx_body *body, gxp_supports *supports, uint32_t copy) {
    uint32_t begin, end, i, count = 1, best = GXP_NONE;
    int k;
    supports->search++;
    supports->queue[0] = copy;
    supports->seen[copy] = supports->search;
    for (begin = 0; begin < count && best == GXP_NONE; begin = end) {
        double least = HUGE_VAL, weight[4], sum;
        uint32_t known = GXP_NONE;
        for (i = begin, end = count; i < end; i++) {
            gxp_around around = gxp_around_copy(body, supports->queue[i]);
            if (known == GXP_NONE) known = supports->cell[supports->queue[i]];
            while (gxp_next_around(body, &around)) {
                if (gxp_is_strong(body, supports, around.cell) &&
                    (sum = gxp_follow_weights(body, copy, around.cell, weight)) < least) {
                    least = sum;
                    best = around.cell;
                }
                for (k = 0; k < 4; k++) {
                    const uint32_t other = body->cells.data[around.cell].copies[k];
                    if (supports->seen[other] == supports->search) continue;
                    supports->seen[other] = supports->search;
                    supports->queue[count++] = other;
                }
            }
        }
        if (best == GXP_NONE) best = known;
        for (i = 0; i < begin && best != GXP_NONE; i++)
            if (supports->weak[supports->queue[i]] && supports->cell[supports->queue[i]] == GXP_NONE)
                supports->cell[supports->queue[i]] = best;
    }
    return best == GXP_NONE ? count : 0;
}

/* How far a cell reaches within its element: the square root of the trace of its covariance in barycentric coordinates
   over that of the element, which is 4 (1/10 - 1/16). The reach of a speck in a corner is about its size; the reach of
   a layer, however thin, is about 1. */
static double gxp_cell_reach(const gxp_cell *cell) {
    double mass = 0, trace = 0;
    int i, k;
    for (i = 0; i < 4; i++)
        for (k = 0; k < 4; k++) mass += cell->mass[gxp_mass_at[i][k]];
    for (i = 0; i < 4 && mass > 0; i++) {
        const double mean = gxp_mass_row(cell->mass, i) / mass;
        trace += cell->mass[gxp_mass_at[i][i]] / mass - mean * mean;
    }
    return trace > 0 ? sqrt(trace / 0.15) : 0;
}

/* A fragment without a strong cell: the first `count` copies of the queue. Either its copies are weak by comparison
   with its fullest part, or it is a speck and moves as a point. */
static void gxp_weigh_fragment(const gx_body *body, gxp_supports *supports, uint32_t count) {
    uint32_t i, fullest = GXP_NONE, lead;
    double most = 0, reach = 0;
    for (i = 0; i < count; i++) {
        gxp_around around = gxp_around_copy(body, supports->queue[i]);
        while (gxp_next_around(body, &around)) {
            const double share = gxp_part_share(body, around.cell);
            if (fullest == GXP_NONE || share > most) {
                most = share;
                fullest = around.cell;
            }
            reach = fmax(reach, gxp_cell_reach(&body->cells.data[around.cell]));
        }
    }
    lead = body->cells.data[fullest].copies[0];
    for (i = 0; i < count; i++) {
        const uint32_t copy = supports->queue[i];
        if (most >= body->config.speck_below && reach >= body->config.speck_reach)
            supports->weak[copy] = gxp_is_weak(body, copy, body->config.follow_below * most) ? GXP_FOLLOWS : GXP_FREE;
        else {
            supports->weak[copy] = copy == lead ? GXP_FREE : GXP_FOLLOWS_POINT;
            supports->cell[copy] = fullest;
        }
    }
}

/* Finds the weak copies of the body and what each follows. Returns their number. */
static uint32_t gxp_find_supports(const gx_body *body, gxp_supports *supports) {
    uint32_t i, cell, count = 0;
    int k;
    supports->search = 1;
    for (i = 0; i < body->model.thin.count; i++)
        for (cell = body->model.thin.data[i]; cell != GXP_NONE; cell = body->cells.data[cell].next)
            for (k = 0; k < 4 && body->cells.data[cell].kept; k++) {
                const uint32_t copy = body->cells.data[cell].copies[k];
                if (supports->seen[copy] == supports->search) continue;
                supports->seen[copy] = supports->search;
                supports->weak[copy] = gxp_is_weak(body, copy, body->config.follow_below) ? GXP_FOLLOWS : GXP_FREE;
            }
    for (i = 0; i < body->copies.count; i++) {
        while (supports->weak[i] && supports->cell[i] == GXP_NONE) {
            const uint32_t met = gxp_find_cell(body, supports, i);
            if (met > 0) gxp_weigh_fragment(body, supports, met);
        }
        count += supports->weak[i] != GXP_FREE;
    }
    return count;
}

/* Copies of a speck move as a point, so in the model none of them is affine. */
static void gxp_make_plain(gx_body *body, const gxp_supports *supports, uint32_t copy) {
    const uint32_t *master = body->cells.data[supports->cell[copy]].copies;
    int k;
    for (k = 0; k < 4; k++) body->hidden.plain[master[k]] = 1;
    body->hidden.plain[copy] = 1;
}

static void gxp_add_constraint(gx_body *body, const gxp_supports *supports, uint32_t copy) {
    gxs_constraint *constraint = &body->model.constraints[body->model.constraint_count++];
    if (body->copies.bends && supports->weak[copy] == GXP_FOLLOWS_POINT) gxp_make_plain(body, supports, copy);
    constraint->copy = copy;
    memcpy(constraint->master, body->cells.data[supports->cell[copy]].copies, sizeof constraint->master);
    memset(constraint->weight, 0, sizeof constraint->weight);
    if (supports->weak[copy] == GXP_FOLLOWS)
        (void)gxp_follow_weights(body, copy, supports->cell[copy], constraint->weight);
    else
        constraint->weight[0] = 1;
}

/* One constraint for each weak copy */
static gx_result gxp_make_constraints(gx_body *body) {
    const gx_allocator *a = &body->config.allocator;
    const size_t n = body->copies.count;
    gxp_supports supports;
    uint32_t i, count;
    gx_result result = GX_OK;
    body->model.constraint_count = 0;
    if (body->model.thin.count == 0) return GX_OK;
    supports.weak = (uint8_t *)gxp_allocate(a, n);
    supports.cell = (uint32_t *)gxp_allocate(a, 3 * n * sizeof(uint32_t));
    if (supports.weak != NULL && supports.cell != NULL) {
        supports.queue = supports.cell + n;
        supports.seen = supports.queue + n;
        memset(supports.weak, 0, n);
        memset(supports.cell, 0xff, n * sizeof *supports.cell);
        memset(supports.seen, 0, n * sizeof *supports.seen);
        count = gxp_find_supports(body, &supports);
        result = gxp_reserve(a, &body->model.constraints, sizeof *body->model.constraints, 0,
                             &body->model.constraint_capacity, count);
        for (i = 0; i < n && result == GX_OK; i++)
            if (supports.weak[i]) gxp_add_constraint(body, &supports, i);
    } else
        result = GX_ERROR_MEMORY;
    gxp_release(a, supports.weak, n);
    gxp_release(a, supports.cell, 3 * n * sizeof(uint32_t));
    return result;
}

/* >>model: the model that the solver takes ------------------------------------------------------------------------- */
/* In: cells, copies, held flags. Out: the solver's model, made anew or changed where cuts have been. The cells of an
   element that are of one material and move by the same four copies are one element of the model, a part. Touches the
   solver and the model's arrays, which are there only while it is made. */

/* Adds a cell to the part with its copies and material, or begins a new part. first: the element's first part. */
static void gxp_add_part(gx_body *body, const gxp_cell *cell, uint32_t first, const double gradients[12]) {
    gxs_element *part;
    uint32_t i;
    int k;
    for (i = first; i < body->model.part_count; i++)
        if (memcmp(body->model.parts[i].copy, cell->copies, sizeof cell->copies) == 0 &&
            body->model.parts[i].material == cell->material)
            break;
    part = &body->model.parts[i];
    if (i == body->model.part_count) {
        memset(part, 0, sizeof *part);
        memcpy(part->copy, cell->copies, sizeof part->copy);
        memcpy(part->gradient, gradients, 12 * sizeof *gradients);
        part->material = cell->material;
        part->group = cell->element;
        body->model.part_count++;
    }
    part->weight += cell->volume;
    for (k = 0; k < 10; k++) part->mass[k] += cell->mass[k];
}

/* Appends the parts of an element; there is room. */
static gx_result gxp_add_parts(gx_body *body, uint32_t element, gx_failure *failure) {
    const uint32_t first = body->model.part_count;
    double x[12], gradients[12];
    uint32_t cell;
    gx_result result;
    gxp_element_positions(body, element, x);
    result = gxi_tet_gradients(x, gradients, NULL);
    if (result != GX_OK) return gxp_fail(failure, result, NULL, element);
    for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        if (body->cells.data[cell].kept) gxp_add_part(body, &body->cells.data[cell], first, gradients);
    return result;
}

/* The parts of all elements */
static gx_result gxp_make_parts(gx_body *body, gx_failure *failure) {
    uint32_t e;
    gx_result result = gxp_reserve(&body->config.allocator, &body->model.parts, sizeof *body->model.parts, 0,
                                   &body->model.part_capacity, body->cells.count);
    body->model.part_count = 0;
    for (e = 0; e < body->mesh.element_count && result == GX_OK; e++) result = gxp_add_parts(body, e, failure);
    return result;
}

/* Affine copies and constraints */
static gx_result gxp_make_affine(gx_body *body) {
    gxp_hidden *hidden = &body->hidden;
    const uint32_t n = body->copies.count;
    uint32_t i, k;
    gx_result result;
    hidden->copies.count = hidden->first.count = 0;
    if (!body->copies.bends) return gxp_make_constraints(body);
    result = gxp_reserve(&body->config.allocator, &hidden->plain, 1, 0, &hidden->plain_capacity, n);
    if (result != GX_OK) return result;
    if (n > 0) memset(hidden->plain, 0, n);
    result = gxp_make_constraints(body);
    for (i = 0; i < n && result == GX_OK; i++)
        if (body->copies.affine[i] && !hidden->plain[i]) result = gxp_push(body, &hidden->copies, i);
    if (result == GX_OK) result = gxp_start_words(body, &hidden->first, gxp_vector_count(body));
    if (result == GX_OK)
        result =
            gxp_reserve(&body->config.allocator, &hidden->held, 1, 0, &hidden->held_capacity, gxp_vector_count(body));
    if (result != GX_OK) hidden->copies.count = 0;
    if (hidden->copies.count == 0) return result;
    hidden->first.count = (uint32_t)gxp_vector_count(body);
    memset(hidden->first.data, 0xff, hidden->first.count * sizeof *hidden->first.data);
    memcpy(hidden->held, body->copies.held, n);
    for (i = 0; i < hidden->copies.count; i++) {
        hidden->first.data[hidden->copies.data[i]] = n + 3 * i;
        for (k = 0; k < 3; k++) hidden->held[n + 3 * i + k] = body->copies.held[hidden->copies.data[i]];
    }
    return GX_OK;
}

/* The whole model. Its arrays are the body's. */
static gx_result gxp_make_model(gx_body *body, gxs_model *model, gx_failure *failure) {
    const gx_allocator *a = &body->config.allocator;
    uint32_t i;
    gx_result result = gxp_make_parts(body, failure);
    if (result == GX_OK) result = gxp_list_thin(body, 1);
    if (result == GX_OK) result = gxp_make_affine(body);
    if (result == GX_OK)
        result = gxp_reserve(a, &body->model.rest, 3 * sizeof(double), 0, &body->model.rest_capacity,
                             gxp_vector_count(body));
    if (result == GX_OK)
        result = gxp_reserve(a, &body->model.elastic, sizeof *body->model.elastic, 0, &body->model.elastic_capacity,
                             body->mesh.material_count);
    if (result != GX_OK) return result;
    for (i = 0; i < gxp_vector_count(body); i++) {
        const uint32_t copy = i < body->copies.count ? i : body->hidden.copies.data[(i - body->copies.count) / 3];
        memcpy(body->model.rest + 3 * (size_t)i, body->mesh.positions + 3 * (size_t)body->copies.node[copy],
               3 * sizeof(double));
    }
    for (i = 0; i < body->mesh.material_count; i++) body->model.elastic[i] = body->mesh.materials[i].elastic;
    memset(model, 0, sizeof *model);
    model->copy_count = gxp_vector_count(body);
    model->positions = body->model.rest;
    model->elements = body->model.parts;
    model->element_count = body->model.part_count;
    model->materials = body->model.elastic;
    model->material_count = body->mesh.material_count;
    model->held = body->hidden.copies.count > 0 ? body->hidden.held : body->copies.held;
    model->affine = body->hidden.copies.count > 0 ? body->hidden.first.data : NULL;
    model->affine_length = body->mesh.affine_length;
    model->constraints = body->model.constraints;
    model->constraint_count = body->model.constraint_count;
    model->epoch = body->cuts.epoch;
    return GX_OK;
}

/* Lists the elements around copies that are affine in the model and were not, or the other way round. before: by copy
   of the model before, its first hidden vector */
static gx_result gxp_list_bent(gx_body *body, const gxp_words *before) {
    gx_result result = GX_OK;
    uint32_t i;
    for (i = 0; i < body->copies.count && result == GX_OK; i++) {
        gxp_around around = gxp_around_copy(body, i);
        if ((body->hidden.first.data[i] == GXS_NOT_AFFINE) ==
            (before->data[body->copies.before[i] >> 1] == GXS_NOT_AFFINE))
            continue;
        while (result == GX_OK && gxp_next_around(body, &around))
            result = gxp_push(body, &body->model.changed, body->cells.data[around.cell].element);
    }
    gxp_sort_unique(&body->model.changed);
    return result;
}

/* Origins of copies and hidden vectors. before: as in gxp_list_bent */
static gx_result gxp_vector_origins(gx_body *body, const gxp_words *before, gxp_words *origins) {
    const gxp_words *copies = &body->hidden.copies;
    gx_result result = gxp_start_words(body, origins, gxp_vector_count(body));
    uint32_t i, k;
    if (result != GX_OK) return result;
    memcpy(origins->data, body->copies.before, body->copies.count * sizeof *origins->data);
    for (i = 0; i < copies->count; i++) {
        const uint32_t origin = body->copies.before[copies->data[i]], first = before->data[origin >> 1];
        for (k = 0; k < 3; k++)
            origins->data[body->copies.count + 3 * i + k] =
                first == GXS_NOT_AFFINE ? origin | 1 : 2 * (first + k) | (origin & 1);
    }
    return GX_OK;
}

/* Affine copies, in place of those of the model before. before, origins: of the call */
static gx_result gxp_change_affine(gx_body *body, gxp_words *before, gxp_words *origins) {
    const gxp_words last = body->hidden.first;
    gx_result result;
    body->hidden.first = *before;
    *before = last;
    result = gxp_make_affine(body);
    if (result != GX_OK || before->count == 0 || body->hidden.copies.count == 0) return result;
    result = gxp_list_bent(body, before);
    return result == GX_OK ? gxp_vector_origins(body, before, origins) : result;
}

/* Applies the changes to the solver's model. After LIMIT, or EMPTY if no part is left, the model must be set whole, and
   nothing has failed. After MEMORY it must be set whole too, but the call has failed. */
static gx_result gxp_change_model(gx_body *body, gx_failure *failure) {
    gxp_model *model = &body->model;
    gxp_hidden *hidden = &body->hidden;
    size_t room = 0;
    uint32_t i, cell;
    gxs_change change;
    gx_result result;
    gxp_sort_unique(&model->changed);
    result = gxp_list_thin(body, 0);
    if (result == GX_OK) result = gxp_change_affine(body, &hidden->before, &hidden->origins);
    for (i = 0; i < model->changed.count; i++)
        for (cell = model->changed.data[i]; cell != GXP_NONE; cell = body->cells.data[cell].next) room++;
    if (result == GX_OK)
        result =
            gxp_reserve(&body->config.allocator, &model->parts, sizeof *model->parts, 0, &model->part_capacity, room);
    model->part_count = 0;
    for (i = 0; i < model->changed.count && result == GX_OK; i++)
        result = gxp_add_parts(body, model->changed.data[i], failure);
    if (result == GX_OK && (hidden->before.count > 0) != (hidden->copies.count > 0)) result = GX_ERROR_LIMIT;
    memset(&change, 0, sizeof change);
    change.copy_count = gxp_vector_count(body);
    change.origins = hidden->copies.count > 0 ? hidden->origins.data : body->copies.before;
    change.held = hidden->copies.count > 0 ? hidden->held : body->copies.held;
    change.affine = hidden->copies.count > 0 ? hidden->first.data : NULL;
    change.groups = model->changed.data;
    change.group_count = model->changed.count;
    change.elements = model->parts;
    change.element_count = model->part_count;
    change.constraints = model->constraints;
    change.constraint_count = model->constraint_count;
    change.epoch = body->cuts.epoch;
    return result == GX_OK ? gxs_solver_update(body->solver, &change, failure) : result;
}

/* Makes sure that copies whose state was written since the last step wake in the next one. */
static void gxp_note_written(gx_body *body) {
    gxp_wake_resumed(body, body->copies.count);
    gxs_solver_note_written(body->solver, body->copies.before, body->copies.count, body->copies.displacement,
                            body->copies.velocity, body->copies.rest_time);
}

/* Gives the solver the whole model. */
static gx_result gxp_set_model(gx_body *body, gx_failure *failure) {
    gxs_model model;
    gx_result result = gxp_make_model(body, &model, failure);
    gxp_note_written(body);
    if (result != GX_OK) return result;
    body->model.empty = model.element_count == 0;
    return body->model.empty ? GX_OK : gxs_solver_set_model(body->solver, &model, failure);
}

/* Releases the arrays that the solver has copied. */
static void gxp_release_model(gx_body *body) {
    gxp_release_columns(body, gxp_model_lists, sizeof gxp_model_lists / sizeof *gxp_model_lists);
}

/* Brings the solver's model up to date after cuts and holds. The solver copies it, so that the arrays are released. */
static gx_result gxp_update_model(gx_body *body, gx_failure *failure) {
    gxp_model *model = &body->model;
    gx_result result = gxp_update_held(body);
    uint32_t i;
    if (result != GX_OK || model->state == GXP_MODEL_KNOWN) {
        gxp_release_model(body);
        return result;
    }
    if (model->state == GXP_MODEL_CHANGED) {
        result = gxp_change_model(body, failure);
        model->state = result == GX_OK ? GXP_MODEL_KNOWN : GXP_MODEL_STALE;
        model->updated = 1;
        if (result == GX_ERROR_LIMIT || result == GX_ERROR_EMPTY) result = GX_OK;
    }
    if (result == GX_OK && model->state == GXP_MODEL_STALE) {
        result = gxp_set_model(body, failure);
        if (result == GX_OK) {
            model->state = GXP_MODEL_KNOWN;
            model->updated = 0;
        }
    }
    gxp_release_model(body);
    model->changed.count = 0;
    for (i = 0; i < body->copies.count; i++) body->copies.before[i] = 2 * i;
    return result;
}

GXFEM_API gx_result gx_body_model(gx_body *body, gxs_model *model, gx_failure *failure) {
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (model == NULL) return gxp_refuse(failure, "model");
    gxp_end(failure, GX_OK);
    result = gxp_update_held(body);
    /* the solver's hidden vectors are no longer known */
    if (body->copies.bends && body->model.state == GXP_MODEL_CHANGED) body->model.state = GXP_MODEL_STALE;
    if (result == GX_OK) result = gxp_make_model(body, model, failure);
    return gxp_close(failure, result);
}

/* >>corners: the skin: normals and textures ------------------------------------------------------------------------ */
/* The visual surface takes four sections. This one: which corners of the outer surface are shaded as one, and which
   texture a cut face has. In: the mesh, the records of surfaces. Out: groups of corners. Touches the skin only. */

/* Sets a normal of length 1. It is left alone if n is zero or not finite. */
static void gxp_set_normal(float *normal, const double n[3]) {
    double unit[3];
    int k;
    if (gxp_unit(n, unit))
        for (k = 0; k < 3; k++) normal[k] = (float)unit[k];
}

/* The normal of the outer face opposite to the element's node k; its length is the area. */
static void gxp_outer_normal(const gx_body *body, uint32_t element, uint32_t k, double n[3]) {
    double x[12], a[3], b[3];
    const uint8_t *f = gxp_outward[k];
    int i;
    gxp_element_positions(body, element, x);
    for (i = 0; i < 3; i++) {
        a[i] = x[3 * f[1] + i] - x[3 * f[0] + i];
        b[i] = x[3 * f[2] + i] - x[3 * f[0] + i];
    }
    for (i = 0; i < 3; i++) n[i] = 0.5 * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
}

/* Lists the outer faces as element * 4 + k; skin.boundary has the number of each mesh face among them. */
static gx_result gxp_list_outer_faces(gx_body *body) {
    const gxb_complex *cx = body->complex;
    gxp_skin *s = &body->skin;
    uint32_t e, k;
    gx_result result = gxp_start_words(body, &s->boundary, gxb_complex_face_count(cx));
    body->skin.outer_faces.count = 0;
    for (e = 0; e < body->mesh.element_count && result == GX_OK; e++)
        for (k = 0; k < 4 && result == GX_OK; k++) {
            if (gxp_neighbour(body, e, k) != GXP_NONE) continue;
            s->boundary.data[gxb_complex_element_faces(cx, e)[k]] = body->skin.outer_faces.count;
            result = gxp_push(body, &body->skin.outer_faces, 4 * e + k);
        }
    return result;
}

/* Outer faces p and q meet in the mesh edge from node a to b. If they bend little there, their corners are one
   group. */
static void gxp_join_corners(gx_body *body, uint32_t p, uint32_t q, uint32_t a, uint32_t b) {
    const uint32_t ep = body->skin.outer_faces.data[p], eq = body->skin.outer_faces.data[q];
    uint32_t *group = body->skin.groups.data;
    double m[3], n[3];
    gxp_outer_normal(body, ep / 4, ep % 4, m);
    gxp_outer_normal(body, eq / 4, eq % 4, n);
    if (gxp_unit(m, m) && gxp_unit(n, n) && gxp_dot(m, n) < cos(body->skin.desc.crease_angle)) return;
    gxp_unite(group, 4 * p + (uint32_t)gxp_local_node(body, ep / 4, a),
              4 * q + (uint32_t)gxp_local_node(body, eq / 4, a));
    gxp_unite(group, 4 * p + (uint32_t)gxp_local_node(body, ep / 4, b),
              4 * q + (uint32_t)gxp_local_node(body, eq / 4, b));
}

/* Finds the two outer faces at each mesh edge and joins their corners. */
static gx_result gxp_join_faces(gx_body *body) {
    const gxb_complex *cx = body->complex;
    uint32_t i, j, *first, *second;
    gx_result result = gxp_start_words(body, &body->skin.edge_faces, 2 * (size_t)gxb_complex_mesh_edge_count(cx));
    if (result != GX_OK) return result;
    first = body->skin.edge_faces.data;
    second = first + gxb_complex_mesh_edge_count(cx);
    memset(first, 0xff, 2 * (size_t)gxb_complex_mesh_edge_count(cx) * sizeof *first);
    for (i = 0; i < body->skin.outer_faces.count; i++)
        for (j = 0; j < 6; j++) {
            const uint32_t e = body->skin.outer_faces.data[i] / 4, k = body->skin.outer_faces.data[i] % 4,
                           edge = gxb_complex_element_edges(cx, e)[j];
            const uint32_t a = gxp_edge_nodes[j][0], b = gxp_edge_nodes[j][1];
            if (a == k || b == k || body->mesh.edge_pinched[edge]) continue;
            if (first[edge] == GXP_NONE)
                first[edge] = i;
            else if (second[edge] == GXP_NONE) {
                second[edge] = i;
                gxp_join_corners(body, first[edge], i, gxb_complex_element_nodes(cx, e)[a],
                                 gxb_complex_element_nodes(cx, e)[b]);
            }
        }
    return GX_OK;
}

/* Groups the corners of outer faces. skin.groups: the group of each of the four nodes of an outer face (that of node k
   is not used); skin.group_normals: the normal of each at rest, weighted by area, not of length 1. */
static gx_result gxp_group_corners(gx_body *body) {
    gxp_skin *s = &body->skin;
    uint32_t i, k;
    int j;
    gx_result result = gxp_list_outer_faces(body);
    const uint32_t count = 4 * body->skin.outer_faces.count;
    if (result == GX_OK) result = gxp_start_words(body, &s->groups, count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &s->group_normals, 3 * sizeof(double), 0,
                             &s->group_normal_capacity, count);
    if (result != GX_OK) return result;
    for (i = 0; i < count; i++) s->groups.data[i] = i;
    if (s->desc.crease_angle > 0) result = gxp_join_faces(body);
    if (result != GX_OK) return result;
    for (i = 0; i < count; i++) s->groups.data[i] = gxp_find(s->groups.data, i);
    memset(s->group_normals, 0, 3 * (size_t)count * sizeof(double));
    for (i = 0; i < body->skin.outer_faces.count; i++) {
        double n[3];
        gxp_outer_normal(body, body->skin.outer_faces.data[i] / 4, body->skin.outer_faces.data[i] % 4, n);
        for (k = 0; k < 4; k++)
            for (j = 0; j < 3; j++) s->group_normals[3 * (size_t)s->groups.data[4 * i + k] + (size_t)j] += n[j];
    }
    return GX_OK;
}

/* The affine map to the texture of a cut triangle, or NULL if its surface has none */
static const double *gxp_label_map(const gx_body *body, uint32_t label) {
    uint32_t surface;
    if (label == GXP_NONE) return NULL;
    surface = gxp_label_surface(body, label);
    if (body->cuts.surfaces[surface].map == GXP_NONE) return NULL;
    return body->cuts.maps +
           8 * ((size_t)body->cuts.surfaces[surface].map + label - body->cuts.surfaces[surface].label);
}

/* >>vertices: the skin: slots and vertices ------------------------------------------------------------------------- */
/* A slot sums the normals of the deformed surface: outer ones by copy and group, those of cut faces by vertex. Vertices
   are found by a key that needs no arithmetic. They stand without gaps: the last one takes the place of one that goes.
 */

/* Empties the buckets; there are at least as many as items. */
static gx_result gxp_rehash(gx_body *body, gxp_words *buckets, uint32_t items) {
    uint32_t size = 64;
    gx_result result;
    while (size < items) size *= 2;
    result = gxp_start_words(body, buckets, size);
    if (result == GX_OK) {
        buckets->count = size;
        memset(buckets->data, 0xff, size * sizeof *buckets->data);
    }
    return result;
}

static uint32_t *gxp_slot_bucket(gxp_skin *s, uint32_t copy, uint32_t group) {
    return &s->slot_buckets.data[gxp_mix((uint64_t)copy << 32 | group) & (s->slot_buckets.count - 1)];
}

/* Room for one more slot; the buckets grow with the slots. */
static gx_result gxp_slot_room(gx_body *body) {
    gxp_skin *s = &body->skin;
    const uint32_t before = s->slot_capacity;
    uint32_t i;
    gx_result result =
        gxp_reserve(&body->config.allocator, &s->slots, sizeof *s->slots, s->slot_count, &s->slot_capacity, 1);
    if (result != GX_OK || (s->slot_capacity == before && s->slot_buckets.count > 0)) return result;
    result = gxp_rehash(body, &s->slot_buckets, s->slot_capacity);
    for (i = 0; i < s->slot_count && result == GX_OK; i++) {
        uint32_t *bucket = gxp_slot_bucket(s, s->slots[i].copy, s->slots[i].group);
        if (s->slots[i].copy == GXP_NONE) continue;
        s->slots[i].next = *bucket;
        *bucket = i;
    }
    return result;
}

/* The slot of a copy and a group */
static gx_result gxp_outer_slot(gx_body *body, uint32_t copy, uint32_t group, uint32_t *slot) {
    gxp_skin *s = &body->skin;
    gx_result result = gxp_slot_room(body);
    uint32_t i;
    if (result != GX_OK) return result;
    for (i = *gxp_slot_bucket(s, copy, group); i != GXP_NONE; i = s->slots[i].next)
        if (s->slots[i].copy == copy && s->slots[i].group == group) {
            *slot = i;
            return GX_OK;
        }
    i = s->slot_count++;
    s->slots[i].copy = copy;
    s->slots[i].group = group;
    s->slots[i].next = *gxp_slot_bucket(s, copy, group);
    *gxp_slot_bucket(s, copy, group) = i;
    *slot = i;
    return GX_OK;
}

/* A slot for one vertex: a free one or a new one */
static gx_result gxp_own_slot(gx_body *body, uint32_t *slot) {
    gxp_skin *s = &body->skin;
    gx_result result = GX_OK;
    if (s->free_slot != GXP_NONE) {
        *slot = s->free_slot;
        s->free_slot = s->slots[*slot].next;
        return GX_OK;
    }
    result = gxp_slot_room(body);
    if (result != GX_OK) return result;
    *slot = s->slot_count++;
    s->slots[*slot].copy = GXP_NONE;
    return GX_OK;
}

/* A facet that is shown, as seen from one cell */
typedef struct gxp_skin_face {
    uint32_t element, cell;
    const uint32_t *copies; /* the cell's */
    uint32_t slots[4];      /* outer: of the face's nodes, by local node */
    uint8_t outer;
    uint32_t surface;  /* gx_skin.triangle_surface */
    uint32_t label;    /* the cut triangle, GXP_NONE: none */
    uint32_t plane;    /* of the complex */
    uint32_t group[2]; /* see gxp_skin_key */
    double normal[3];  /* outward at rest, of any length */
} gxp_skin_face;

/* Room for one more vertex; the buckets grow with the vertices. */
static gx_result gxp_vertex_room(gx_body *body) {
    gxp_skin *s = &body->skin;
    const uint32_t before = s->vertex_capacity[0];
    uint32_t i;
    gx_result result = gxp_grow_rows(body, GXP_SKIN_VERTICES, 1);
    if (result != GX_OK || (s->vertex_capacity[0] == before && s->vertex_buckets.count > 0)) return result;
    result = gxp_rehash(body, &s->vertex_buckets, s->vertex_capacity[0]);
    for (i = 0; i < s->vertex_count && result == GX_OK; i++) {
        uint32_t *bucket = gxp_vertex_bucket(s, &s->vertices[i].key);
        s->vertices[i].next = *bucket;
        *bucket = i;
    }
    return result;
}

/* The key of a point of the face; it takes no arithmetic. */
static void gxp_make_key(const gx_body *body, const gxp_skin_face *face, uint32_t point, gxp_skin_key *key) {
    const unsigned support = gxb_complex_support(body->complex, point, face->element);
    uint32_t i, j, n = 0;
    memset(key->name, 0xff, sizeof key->name);
    key->point = gxb_complex_point(body->complex, point)->name;
    key->group[0] = face->group[0];
    key->group[1] = face->group[1];
    for (i = 0; i < 4; i++) {
        const uint32_t name = face->outer ? face->slots[i] : face->copies[i];
        if (!(support >> i & 1) || name == GXP_NONE) continue;
        for (j = n++; j > 0 && key->name[j - 1] > name; j--) key->name[j] = key->name[j - 1];
        key->name[j] = name;
    }
}

/* Copies, weights and slots of a point, those of weight 0 last */
static void gxp_weigh_point(const gxp_skin_face *face, const double lambda[4], uint32_t *copies, double *weights,
                            uint32_t *slots) {
    uint32_t k, n = 0;
    for (k = 0; k < 4; k++) {
        if (!(lambda[k] > 0) || (face->outer && face->slots[k] == GXP_NONE)) continue;
        copies[n] = face->copies[k];
        weights[n] = lambda[k];
        slots[n++] = face->slots[k];
    }
    for (k = n; k < 4; k++) {
        copies[k] = copies[0];
        weights[k] = 0;
        slots[k] = slots[0];
    }
}

/* The texture of a vertex: interpolated on the outer surface, by the map of the cut triangle on faces of a cut */
static void gxp_set_texture(gx_body *body, uint32_t vertex, const gxp_skin_face *face, const double lambda[4]) {
    const double *x = body->skin.rest + 3 * (size_t)vertex, *map = gxp_label_map(body, face->label);
    const uint32_t *node = gxb_complex_element_nodes(body->complex, face->element);
    int i, k;
    for (i = 0; i < 2; i++) {
        double t = map != NULL ? map[4 * i + 3] : 0;
        for (k = 0; k < 3 && map != NULL; k++) t += map[4 * i + k] * (x[k] - gxb_complex_origin(body->complex)[k]);
        for (k = 0; k < 4 && face->outer && body->mesh.texture != NULL; k++)
            t += lambda[k] * (double)body->mesh.texture[2 * (size_t)node[k] + (size_t)i];
        body->skin.texture[2 * (size_t)vertex + (size_t)i] = (float)t;
    }
}

/* Appends a vertex with this key at a point of the complex; there is room. */
static gx_result gxp_add_vertex(gx_body *body, const gxp_skin_face *face, const gxp_skin_key *key, uint32_t point,
                                uint32_t *vertex) {
    gxp_skin *s = &body->skin;
    const uint32_t i = s->vertex_count;
    gxp_skin_vertex *v = &s->vertices[i];
    double *rest = s->rest + 3 * (size_t)i;
    const double *lambda;
    uint32_t n, slot, own = GXP_NONE;
    int k;
    gx_result result = face->outer ? GX_OK : gxp_own_slot(body, &own);
    if (result == GX_OK) result = gxp_add_boundary_point(body, face->element, point, &slot);
    if (result != GX_OK) return result;
    lambda = body->scratch.boundary.lambdas + 4 * (size_t)slot;
    gxp_weigh_point(face, lambda, s->copies + 4 * (size_t)i, s->weights + 4 * (size_t)i, v->slots);
    for (n = 0; n < 4 && !face->outer; n++) v->slots[n] = own;
    v->key = *key;
    v->corner = GXP_NONE;
    v->outer = face->outer;
    v->placed = 1;
    v->noted = 0;
    v->next = *gxp_vertex_bucket(s, key);
    *gxp_vertex_bucket(s, key) = i;
    s->point[i] = key->point;
    for (k = 0; k < 3; k++) {
        rest[k] = 0;
        for (n = 0; n < 4; n++)
            rest[k] += s->weights[4 * (size_t)i + n] *
                       body->mesh.positions[3 * (size_t)body->copies.node[s->copies[4 * (size_t)i + n]] + (size_t)k];
    }
    memset(s->normal + 3 * (size_t)i, 0, 3 * sizeof *s->normal); /* gxp_set_normal may leave it alone */
    gxp_set_normal(s->normal + 3 * (size_t)i, face->normal);
    gxp_set_texture(body, i, face, lambda);
    *vertex = s->vertex_count++;
    return GX_OK;
}

/* Notes a vertex that may have changed. */
static gx_result gxp_note_vertex(gx_body *body, uint32_t vertex) {
    gxp_skin_vertex *v = &body->skin.vertices[vertex];
    if (v->noted) return GX_OK;
    v->noted = 1;
    return gxp_push(body, &body->skin.changed[0], vertex);
}

/* Finds or appends the vertex of a point. */
static gx_result gxp_find_vertex(gx_body *body, const gxp_skin_face *face, uint32_t point, uint32_t *vertex) {
    gxp_skin *s = &body->skin;
    gxp_skin_key key;
    gx_result result;
    gxp_make_key(body, face, point, &key);
    *vertex = s->vertex_buckets.count > 0 ? *gxp_vertex_bucket(s, &key) : GXP_NONE;
    for (; *vertex != GXP_NONE; *vertex = s->vertices[*vertex].next)
        if (memcmp(&s->vertices[*vertex].key, &key, sizeof key) == 0) return gxp_note_vertex(body, *vertex);
    result = gxp_vertex_room(body);
    if (result == GX_OK) result = gxp_add_vertex(body, face, &key, point, vertex);
    return result == GX_OK ? gxp_note_vertex(body, *vertex) : result;
}

/* Removes a vertex without triangles. The last one takes its place. */
static gx_result gxp_drop_vertex(gx_body *body, uint32_t vertex) {
    gxp_skin *s = &body->skin;
    const uint32_t last = --s->vertex_count;
    uint32_t *link, corner;
    gx_result result = GX_OK;
    for (link = gxp_vertex_bucket(s, &s->vertices[vertex].key); *link != vertex; link = &s->vertices[*link].next) {}
    *link = s->vertices[vertex].next;
    if (!s->vertices[vertex].outer) {
        s->slots[s->vertices[vertex].slots[0]].next = s->free_slot;
        s->free_slot = s->vertices[vertex].slots[0];
    }
    if (vertex == last) return GX_OK;
    for (link = gxp_vertex_bucket(s, &s->vertices[last].key); *link != last; link = &s->vertices[*link].next) {}
    *link = vertex;
    for (corner = s->vertices[last].corner; corner != GXP_NONE; corner = s->links[corner / 3].corner_next[corner % 3]) {
        s->triangles[corner] = vertex;
        if (result == GX_OK) result = gxp_push(body, &s->changed[1], corner / 3);
    }
    gxp_copy_row(body, GXP_SKIN_VERTICES, last, vertex);
    s->vertices[vertex].placed = 1;
    return result;
}

/* >>faces: the skin: triangles ------------------------------------------------------------------------------------- */
/* In: an element. Out: the triangles that it shows, of outer faces and of both sides of walls. Triangles are listed by
   element and stand without gaps. Facets are divided into triangles with area, so that each has a normal. */

/* Adds the triangle to the lists of its vertices and of its element. */
static void gxp_link_triangle(gxp_skin *s, uint32_t t) {
    gxp_skin_links *own = &s->links[t];
    uint32_t k;
    for (k = 0; k < 3; k++) {
        uint32_t *first = &s->vertices[s->triangles[3 * t + k]].corner;
        own->corner_next[k] = *first;
        own->corner_previous[k] = GXP_NONE;
        if (*first != GXP_NONE) s->links[*first / 3].corner_previous[*first % 3] = 3 * t + k;
        *first = 3 * t + k;
    }
    own->next = s->first.data[s->element[t]];
    own->previous = GXP_NONE;
    if (own->next != GXP_NONE) s->links[own->next].previous = t;
    s->first.data[s->element[t]] = t;
}

static void gxp_unlink_triangle(gxp_skin *s, uint32_t t) {
    const gxp_skin_links *own = &s->links[t];
    uint32_t k;
    for (k = 0; k < 3; k++) {
        const uint32_t next = own->corner_next[k], previous = own->corner_previous[k];
        if (next != GXP_NONE) s->links[next / 3].corner_previous[next % 3] = previous;
        if (previous != GXP_NONE)
            s->links[previous / 3].corner_next[previous % 3] = next;
        else
            s->vertices[s->triangles[3 * t + k]].corner = next;
    }
    if (own->next != GXP_NONE) s->links[own->next].previous = own->previous;
    if (own->previous != GXP_NONE)
        s->links[own->previous].next = own->next;
    else
        s->first.data[s->element[t]] = own->next;
}

/* Removes a triangle. The last one takes its place. */
static gx_result gxp_drop_triangle(gx_body *body, uint32_t t) {
    gxp_skin *s = &body->skin;
    const uint32_t last = s->triangle_count - 1;
    uint32_t k;
    gx_result result = gxp_push(body, &s->changed[1], t);
    for (k = 0; k < 3 && result == GX_OK; k++) result = gxp_note_vertex(body, s->triangles[3 * t + k]);
    if (result != GX_OK) return result;
    gxp_unlink_triangle(s, t);
    s->triangle_count--;
    if (t == last) return GX_OK;
    gxp_unlink_triangle(s, last);
    gxp_copy_row(body, GXP_SKIN_TRIANGLES, last, t);
    gxp_link_triangle(s, t);
    return GX_OK;
}

static gx_result gxp_add_skin_triangle(gx_body *body, const gxp_skin_face *face, const uint32_t vertex[3], int inward) {
    gxp_skin *s = &body->skin;
    const uint32_t t = s->triangle_count;
    uint32_t k, j, *corner;
    gx_result result = gxp_grow_rows(body, GXP_SKIN_TRIANGLES, 1);
    if (result == GX_OK) result = gxp_push(body, &s->changed[1], t);
    if (result != GX_OK) return result;
    corner = s->triangles + 3 * (size_t)t;
    for (k = 0; k < 3; k++) corner[k] = vertex[inward ? 2 - k : k];
    s->triangle_count++;
    s->element[t] = face->element;
    s->cell[t] = face->cell;
    s->material[t] = body->cells.data[face->cell].material;
    s->surface[t] = face->surface;
    memset(s->links[t].normal, 0, sizeof s->links[t].normal);
    gxp_set_normal(s->links[t].normal, face->normal);
    for (k = 0, j = 0; k < 4 && face->outer; k++)
        if (face->slots[k] != GXP_NONE) s->links[t].slots[j++] = face->slots[k];
    for (k = 0; k < 3 && !face->outer; k++) s->links[t].slots[k] = s->vertices[corner[k]].slots[0];
    gxp_link_triangle(s, t);
    return GX_OK;
}

/* May corner i be cut off the polygon, which has area? Then its triangle has area, and so has the rest. */
static int gxp_is_ear(gx_body *body, const uint32_t *p, uint32_t n, uint32_t i, uint32_t plane) {
    const uint32_t before = p[(i + n - 1) % n], after = p[(i + 1) % n];
    uint32_t j;
    if (n == 3) return 1;
    if (gxb_complex_turn(body->complex, before, p[i], after, plane) == 0) return 0;
    for (j = 2; j < n - 1; j++)
        if (gxb_complex_turn(body->complex, before, after, p[(i + j) % n], plane) != 0) return 1;
    return 0;
}

/* Adds a facet as triangles, outward from the leaf, by cutting ears off its convex polygon. Its corners may stand in
   line: only triangles with area have normals. */
static gx_result gxp_add_skin_facet(gx_body *body, const gxp_skin_face *face, uint32_t facet, uint32_t leaf) {
    gxb_complex *cx = body->complex;
    gxp_words *points = &body->skin.corner_points, *vertices = &body->skin.corner_vertices;
    const int inward = gxb_complex_facet(cx, facet)->leaf[0] == leaf;
    uint32_t *p, *v, e0, en, i, n, vertex = GXP_NONE;
    gx_result result = gxb_facet_resolve_edges(cx, facet, &e0, &en);
    points->count = vertices->count = 0;
    for (i = 0; i < en && result == GX_OK; i++) {
        const uint32_t point = gxb_complex_edge_start(cx, gxp_item(cx, e0 + i));
        result = gxp_find_vertex(body, face, point, &vertex);
        if (result == GX_OK) result = gxp_push(body, points, point);
        if (result == GX_OK) result = gxp_push(body, vertices, vertex);
    }
    p = points->data;
    v = vertices->data;
    for (n = points->count, i = 0; n >= 3 && result == GX_OK; n--) {
        uint32_t triangle[3], tries = 0;
        for (i %= n; tries < n && !gxp_is_ear(body, p, n, i, gxb_complex_facet(cx, facet)->plane); i = (i + 1) % n)
            tries++;
        triangle[0] = v[(i + n - 1) % n];
        triangle[1] = v[i];
        triangle[2] = v[(i + 1) % n];
        result = gxp_add_skin_triangle(body, face, triangle, inward);
        memmove(p + i, p + i + 1, (n - 1 - i) * sizeof *p);
        memmove(v + i, v + i + 1, (n - 1 - i) * sizeof *v);
        i++;
    }
    return result;
}

/* Do two cells move apart at a common facet? They do if any copy differs within one element, or if a shared node's
   copies differ. */
static int gxp_cells_part(const gx_body *body, uint32_t a, uint32_t b) {
    const gxp_cell *p = &body->cells.data[a], *q = &body->cells.data[b];
    uint32_t k;
    if (p->element == q->element) return memcmp(p->copies, q->copies, sizeof p->copies) != 0;
    for (k = 0; k < 4; k++) {
        const int j = gxp_local_node(body, q->element, gxb_complex_element_nodes(body->complex, p->element)[k]);
        if (j >= 0 && p->copies[k] != q->copies[j]) return 1;
    }
    return 0;
}

/* -1: the facet is not seen from the leaf; 0: outer surface; 1: face of a cut */
static int gxp_visible(const gx_body *body, uint32_t facet, uint32_t leaf) {
    const gxb_facet *f = gxb_complex_facet(body->complex, facet);
    const uint32_t other = f->leaf[f->leaf[0] == leaf];
    if (other == GXB_NONE) return 0;
    if (gxb_complex_leaf(body->complex, other)->removed) return 1;
    return f->wall && gxp_cells_part(body, body->leaves.data[leaf].cell, body->leaves.data[other].cell) ? 1 : -1;
}

/* The outer face opposite to the element's node k, as the cell shows it */
static gx_result gxp_outer_face(gx_body *body, uint32_t k, gxp_skin_face *face) {
    const uint32_t number = body->skin.boundary.data[gxb_complex_element_faces(body->complex, face->element)[k]];
    uint32_t j;
    gx_result result = GX_OK;
    face->outer = 1;
    face->surface = GX_SKIN_OUTER;
    face->label = GXP_NONE;
    face->group[0] = face->group[1] = 0;
    gxp_outer_normal(body, face->element, k, face->normal);
    for (j = 0; j < 4 && result == GX_OK; j++) {
        face->slots[j] = GXP_NONE;
        if (j != k)
            result = gxp_outer_slot(body, face->copies[j], body->skin.groups.data[4 * number + j], &face->slots[j]);
    }
    return result;
}

/* The face of a cut that the leaf shows at the facet. Of several triangles that cover it the first one counts. */
static void gxp_cut_face(const gx_body *body, uint32_t facet, uint32_t leaf, gxp_skin_face *face) {
    const gxb_complex *cx = body->complex;
    const gxb_facet *f = gxb_complex_facet(cx, facet);
    const int front = f->leaf[0] == leaf;
    uint32_t l, first = GXP_NONE;
    int k;
    for (l = f->labels; l != GXB_NONE; l = gxb_complex_label(cx, l)->next)
        if (first == GXP_NONE || gxb_complex_label(cx, l)->triangle < gxb_complex_label(cx, first)->triangle) first = l;
    face->outer = 0;
    face->label = first == GXP_NONE ? GXP_NONE : gxb_complex_label(cx, first)->triangle;
    face->surface = first == GXP_NONE ? GX_SKIN_SEVERED : 1 + gxp_label_surface(body, face->label);
    memset(face->slots, 0xff, sizeof face->slots);
    for (k = 0; k < 3; k++)
        face->normal[k] =
            front ? -gxb_complex_plane(cx, face->plane)->filter.n[k] : gxb_complex_plane(cx, face->plane)->filter.n[k];
    face->group[0] = face->surface;
    if (body->skin.desc.smooth_cuts && first != GXP_NONE)
        face->group[1] = (uint32_t)(front ^ (gxb_complex_label(cx, first)->orientation < 0));
    else
        face->group[1] = GXP_PLANE_GROUP + 2 * face->plane + (uint32_t)front;
}

/* Adds all that a leaf shows. */
static gx_result gxp_skin_leaf(gx_body *body, uint32_t leaf, gxp_skin_face *face) {
    gxb_complex *cx = body->complex;
    uint32_t first, count, i, k;
    gx_result result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t facet = gxp_item(cx, first + i);
        const int kind = gxp_visible(body, facet, leaf);
        if (kind < 0) continue;
        face->plane = gxb_complex_facet(cx, facet)->plane;
        if (kind == 0) {
            for (k = 0; gxb_complex_element_faces(cx, face->element)[k] != gxb_complex_facet(cx, facet)->face;) k++;
            result = gxp_outer_face(body, k, face);
        } else
            gxp_cut_face(body, facet, leaf, face);
        if (result == GX_OK) result = gxp_add_skin_facet(body, face, facet, leaf);
    }
    return result;
}

/* Adds the outer faces of an element that no cut has touched. */
static gx_result gxp_skin_whole(gx_body *body, gxp_skin_face *face) {
    uint32_t k, j, vertex[3];
    gx_result result = GX_OK;
    face->plane = 0;
    for (k = 0; k < 4 && result == GX_OK; k++) {
        if (gxp_neighbour(body, face->element, k) != GXP_NONE) continue;
        result = gxp_outer_face(body, k, face);
        for (j = 0; j < 3 && result == GX_OK; j++)
            result = gxp_find_vertex(
                body, face, gxb_complex_element_nodes(body->complex, face->element)[gxp_outward[k][j]], &vertex[j]);
        if (result == GX_OK) result = gxp_add_skin_triangle(body, face, vertex, 0);
    }
    return result;
}

/* Is the element's face k as in the mesh: undivided, no wall, and the element behind it kept? */
static int gxp_face_is_whole(const gx_body *body, uint32_t element, uint32_t k) {
    const gxb_complex *cx = body->complex;
    const uint32_t facet = gxb_complex_face_facet(cx, gxb_complex_element_faces(cx, element)[k]);
    const gxb_facet *f;
    uint32_t other;
    if (facet == GXB_NONE) return 1;
    f = gxb_complex_facet(cx, facet);
    other = f->leaf[f->leaf[0] == element];
    return f->child == GXB_NONE && !f->wall && (other == GXB_NONE || !gxb_complex_leaf(cx, other)->removed);
}

/* Does the element show its outer faces as in the mesh, and nothing else? */
static int gxp_is_untouched(const gx_body *body, uint32_t element) {
    const gxb_complex *cx = body->complex;
    uint32_t k;
    if (body->cells.data[element].next != GXP_NONE || gxb_complex_root(cx, element) != 2 * element ||
        gxb_complex_leaf(cx, element)->removed)
        return 0;
    for (k = 0; k < 4; k++)
        if (!gxp_face_is_whole(body, element, k)) return 0;
    for (k = 0; k < 6; k++)
        if (gxp_edge_is_divided(cx, gxb_complex_element_edges(cx, element)[k])) return 0;
    return 1;
}

static int gxp_is_at_boundary(const gx_body *body, uint32_t element) {
    uint32_t k;
    for (k = 0; k < 4; k++)
        if (gxp_neighbour(body, element, k) == GXP_NONE) return 1;
    return 0;
}

/* Adds all that an element shows. */
static gx_result gxp_skin_element(gx_body *body, uint32_t element) {
    const int untouched = gxp_is_untouched(body, element);
    gxp_skin_face face;
    uint32_t cell, leaf;
    gx_result result = GX_OK;
    if (untouched && !gxp_is_at_boundary(body, element)) return GX_OK;
    gxp_clear_boundary(body, 1); /* each point's coordinates are found once for all faces of the element */
    memset(&face, 0, sizeof face);
    face.element = element;
    if (!untouched) result = gxb_complex_open_element(body->complex, element);
    for (cell = element; cell != GXP_NONE && result == GX_OK; cell = body->cells.data[cell].next) {
        if (!body->cells.data[cell].kept) continue;
        face.cell = cell;
        face.copies = body->cells.data[cell].copies;
        if (untouched)
            result = gxp_skin_whole(body, &face);
        else
            for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
                 leaf = body->leaves.data[leaf].next)
                result = gxp_skin_leaf(body, leaf, &face);
    }
    return result;
}

/* >>skinning: the skin: updating and moving it --------------------------------------------------------------------- */
/* In: the elements that cuts have touched. Out: the skin with these made anew, and the ranges that differ; its deformed
   positions and normals. Touches the skin only. */

static gx_result gxp_spread_to(gx_body *body, uint32_t element) {
    if (element == GXP_NONE || body->cells.stamp[element] == body->scratch.stamp) return GX_OK;
    body->cells.stamp[element] = body->scratch.stamp;
    return gxp_push(body, &body->skin.dirty, element);
}

/* Adds the elements that see a touched one: those across its faces, and those around its divided edges, which have a
   further corner there. */
static gx_result gxp_spread_touched(gx_body *body) {
    const gxb_complex *cx = body->complex;
    gxp_words *dirty = &body->skin.dirty;
    uint32_t i, j, k, count;
    gx_result result = GX_OK;
    body->scratch.stamp++;
    for (i = 0, count = 0; i < dirty->count; i++) {
        if (body->cells.stamp[dirty->data[i]] == body->scratch.stamp) continue;
        body->cells.stamp[dirty->data[i]] = body->scratch.stamp;
        dirty->data[count++] = dirty->data[i];
    }
    dirty->count = count;
    for (i = 0; i < count && result == GX_OK; i++) {
        const uint32_t e = dirty->data[i];
        for (k = 0; k < 4 && result == GX_OK; k++) result = gxp_spread_to(body, gxp_neighbour(body, e, k));
        for (k = 0; k < 6; k++) {
            const uint32_t a = gxb_complex_element_nodes(cx, e)[gxp_edge_nodes[k][0]],
                           b = gxb_complex_element_nodes(cx, e)[gxp_edge_nodes[k][1]];
            if (!gxp_edge_is_divided(cx, gxb_complex_element_edges(cx, e)[k])) continue;
            for (j = body->mesh.node_start[a]; j < body->mesh.node_start[a + 1] && result == GX_OK; j++)
                if (gxp_local_node(body, body->mesh.node_elements[j], b) >= 0)
                    result = gxp_spread_to(body, body->mesh.node_elements[j]);
        }
    }
    return result;
}

/* The normal of a vertex at rest. On the outer surface it is interpolated from the groups of the uncut mesh. On faces
   of a cut it is the mean over the facets around, weighted by area; the facets' own normals are used, since the corners
   of a triangle may be rounded to a line. */
static void gxp_rest_normal(const gxp_skin *s, uint32_t vertex, float *normal) {
    double n[3] = {0, 0, 0}, a[3], unit[3];
    uint32_t corner, i;
    int k;
    if (s->vertices[vertex].outer) {
        for (i = 0; i < 4; i++)
            for (k = 0; k < 3; k++)
                n[k] += s->weights[4 * vertex + i] *
                        s->group_normals[3 * (size_t)s->slots[s->vertices[vertex].slots[i]].group + (size_t)k];
    } else
        for (corner = s->vertices[vertex].corner; corner != GXP_NONE;
             corner = s->links[corner / 3].corner_next[corner % 3]) {
            gxp_triangle_normal(s->rest, s->triangles + 3 * (size_t)(corner / 3), a);
            if (gxp_unit(a, unit))
                for (k = 0; k < 3; k++) n[k] += gxp_dot(a, unit) * (double)s->links[corner / 3].normal[k];
        }
    gxp_set_normal(normal, n);
}

static gx_result gxp_drop_lonely_vertices(gx_body *body) {
    gxp_skin *s = &body->skin;
    uint32_t i;
    gx_result result = GX_OK;
    gxp_sort_unique(&s->changed[0]);
    /* from the end, so that the last vertex, which takes the place of a dropped one, is not dropped itself */
    for (i = s->changed[0].count; i-- > 0 && result == GX_OK;) {
        const uint32_t vertex = s->changed[0].data[i];
        if (s->vertices[vertex].corner == GXP_NONE) result = gxp_drop_vertex(body, vertex);
    }
    return result;
}

/* Renews the normals of the noted vertices; skin.changed[0] keeps the vertices that differ from before. */
static void gxp_renew_normals(gxp_skin *s) {
    uint32_t i, n = 0;
    for (i = 0; i < s->changed[0].count; i++) {
        const uint32_t vertex = s->changed[0].data[i];
        float normal[3];
        if (vertex >= s->vertex_count) continue;
        memcpy(normal, s->normal + 3 * (size_t)vertex, sizeof normal);
        gxp_rest_normal(s, vertex, normal);
        if (s->vertices[vertex].placed || memcmp(normal, s->normal + 3 * (size_t)vertex, sizeof normal) != 0)
            s->changed[0].data[n++] = vertex;
        memcpy(s->normal + 3 * (size_t)vertex, normal, sizeof normal);
        s->vertices[vertex].placed = s->vertices[vertex].noted = 0;
    }
    s->changed[0].count = n;
}

/* Turns the list of changed items into ranges. */
static gx_result gxp_make_ranges(gx_body *body, int kind, uint32_t count) {
    gxp_skin *s = &body->skin;
    gxp_words *changed = &s->changed[kind];
    gx_result result = GX_OK;
    uint32_t i, n = 0;
    gxp_sort_unique(changed);
    for (i = 0; i < changed->count && changed->data[i] < count && result == GX_OK; i++) {
        if (n > 0 && s->ranges[kind][n - 1].first + s->ranges[kind][n - 1].count == changed->data[i]) {
            s->ranges[kind][n - 1].count++;
            continue;
        }
        result =
            gxp_reserve(&body->config.allocator, &s->ranges[kind], sizeof **s->ranges, n, &s->range_capacity[kind], 1);
        if (result != GX_OK) break;
        s->ranges[kind][n].first = changed->data[i];
        s->ranges[kind][n++].count = 1;
    }
    s->range_count[kind] = n;
    changed->count = 0;
    return result;
}

/* Empties the skin and marks every element to be made. */
static gx_result gxp_restart_skin(gx_body *body, const gx_skin_desc *desc) {
    gxp_skin *s = &body->skin;
    uint32_t e;
    gx_result result;
    s->desc = *desc;
    s->vertex_count = s->triangle_count = s->slot_count = 0;
    s->free_slot = GXP_NONE;
    s->changed[0].count = s->changed[1].count = s->vertex_buckets.count = s->slot_buckets.count = 0;
    result = gxp_group_corners(body);
    if (result == GX_OK) result = gxp_start_words(body, &s->first, body->mesh.element_count);
    if (result == GX_OK) result = gxp_start_words(body, &s->dirty, body->mesh.element_count);
    if (result != GX_OK) return result;
    memset(s->first.data, 0xff, body->mesh.element_count * sizeof *s->first.data);
    for (e = 0; e < body->mesh.element_count; e++) s->dirty.data[s->dirty.count++] = e;
    return GX_OK;
}

/* Makes the dirty elements anew. */
static gx_result gxp_remake_elements(gx_body *body) {
    gxp_skin *s = &body->skin;
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < s->dirty.count && result == GX_OK; i++)
        while (s->first.data[s->dirty.data[i]] != GXP_NONE && result == GX_OK)
            result = gxp_drop_triangle(body, s->first.data[s->dirty.data[i]]);
    for (i = 0; i < s->dirty.count && result == GX_OK; i++) result = gxp_skin_element(body, s->dirty.data[i]);
    s->dirty.count = 0;
    if (result != GX_OK) return result;
    result = gxp_drop_lonely_vertices(body);
    if (result == GX_OK) gxp_renew_normals(s);
    return result;
}

/* Writes the fragment of each triangle. */
static gx_result gxp_mark_fragments(gx_body *body) {
    gxp_skin *s = &body->skin;
    uint32_t t;
    const gx_result result = gxp_update_labels(body);
    for (t = 0; t < s->triangle_count && result == GX_OK; t++)
        s->fragment[t] =
            body->view.fragment_number
                .data[gxp_find(body->view.copy_fragment.data, s->copies[4 * (size_t)s->triangles[3 * (size_t)t]])];
    return result;
}

/* Brings the skin up to date. After an error it counts as unmade, so that the next call makes all of it. */
static gx_result gxp_update_skin(gx_body *body, const gx_skin_desc *desc) {
    gxp_skin *s = &body->skin;
    const int all = !s->made || desc->crease_angle < s->desc.crease_angle ||
                    desc->crease_angle > s->desc.crease_angle || desc->smooth_cuts != s->desc.smooth_cuts;
    gx_result result;
    s->made = 0;
    s->range_count[0] = s->range_count[1] = 0;
    result = all ? gxp_restart_skin(body, desc) : gxp_spread_touched(body);
    if (result == GX_OK) result = gxp_remake_elements(body);
    if (result == GX_OK) result = gxp_mark_fragments(body);
    if (result == GX_OK) result = gxp_make_ranges(body, 0, s->vertex_count);
    if (result == GX_OK) result = gxp_make_ranges(body, 1, s->triangle_count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &s->normals, 3 * sizeof(double), 0, &s->normal_capacity,
                             s->slot_count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &s->positions, 3 * sizeof(double), 0, &s->position_capacity,
                             s->vertex_count);
    if (result == GX_OK) s->made = 1;
    return result;
}

static void gxp_show_skin(const gx_body *body, gx_skin *skin) {
    const gxp_skin *s = &body->skin;
    skin->vertex_count = s->vertex_count;
    skin->vertex_width = 4;
    skin->vertex_copies = s->copies;
    skin->vertex_weights = s->weights;
    skin->vertex_point = s->point;
    skin->vertex_rest = s->rest;
    skin->vertex_normal = s->normal;
    skin->vertex_texture = s->texture;
    skin->triangle_count = s->triangle_count;
    skin->triangles = s->triangles;
    skin->triangle_fragment = s->fragment;
    skin->triangle_element = s->element;
    skin->triangle_material = s->material;
    skin->triangle_surface = s->surface;
    skin->vertex_ranges = s->ranges[0];
    skin->vertex_range_count = s->range_count[0];
    skin->triangle_ranges = s->ranges[1];
    skin->triangle_range_count = s->range_count[1];
    skin->epoch = body->cuts.epoch;
}

GXFEM_API gx_result gx_body_skin(gx_body *body, const gx_skin_desc *desc, gx_skin *skin, gx_failure *failure) {
    gx_skin_desc none;
    gx_result result;
    memset(&none, 0, sizeof none);
    if (desc == NULL) desc = &none;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (skin == NULL) return gxp_refuse(failure, "skin");
    if (!gxp_is_finite(desc->crease_angle)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "crease_angle", SIZE_MAX);
    if (desc->crease_angle < 0) return gxp_refuse(failure, "crease_angle");
    result = gxp_update_skin(body, desc);
    if (result == GX_OK) gxp_show_skin(body, skin);
    return gxp_end(failure, result);
}

/* x = X + sum of weight u, in doubles */
static void gxp_move_vertices(const gx_body *body, double *positions) {
    const gxp_skin *s = &body->skin;
    size_t i;
    for (i = 0; i < s->vertex_count; i++)
        gxp_map_point(body, s->rest + 3 * i, s->copies + 4 * i, s->weights + 4 * i, 4, positions + 3 * i);
}

/* Sums the normals of triangles in their slots, then interpolates those of vertices from their slots. */
static void gxp_deformed_normals(gxp_skin *s, float *normals) {
    size_t i;
    int k, n;
    if (s->slot_count > 0) memset(s->normals, 0, 3 * (size_t)s->slot_count * sizeof *s->normals);
    for (i = 0; i < s->triangle_count; i++) {
        double a[3];
        gxp_triangle_normal(s->positions, s->triangles + 3 * i, a);
        for (n = 0; n < 3; n++)
            for (k = 0; k < 3; k++) s->normals[3 * (size_t)s->links[i].slots[n] + (size_t)k] += a[k];
    }
    for (i = 0; i < s->vertex_count; i++) {
        double a[3] = {0, 0, 0};
        for (n = 0; n < 4 && s->weights[4 * i + (size_t)n] > 0; n++)
            for (k = 0; k < 3; k++)
                a[k] += s->weights[4 * i + (size_t)n] * s->normals[3 * (size_t)s->vertices[i].slots[n] + (size_t)k];
        memcpy(normals + 3 * i, s->normal + 3 * i, 3 * sizeof *normals);
        gxp_set_normal(normals + 3 * i, a);
    }
}

/* Is there a skin, and has no cut been since it was made? */
static int gxp_has_skin(const gx_body *body) { return body->skin.made && body->skin.dirty.count == 0; }

GXFEM_API gx_result gx_body_skin_positions(const gx_body *body, double *positions, gx_failure *failure) {
    if (body == NULL) return gxp_refuse(failure, "body");
    if (positions == NULL) return gxp_refuse(failure, "positions");
    if (!gxp_has_skin(body)) return gxp_fail(failure, GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    gxp_move_vertices(body, positions);
    return gxp_end(failure, GX_OK);
}

static gx_result gxp_check_vector(const double x[3], const char *field, gx_failure *failure) {
    return gxp_is_finite(x[0]) && gxp_is_finite(x[1]) && gxp_is_finite(x[2])
             ? GX_OK
             : gxp_fail(failure, GX_ERROR_NOT_FINITE, field, SIZE_MAX);
}

GXFEM_API gx_result gx_body_skin_vertices(gx_body *body, const double origin[3], float *positions, float *normals,
                                          gx_failure *failure) {
    gxp_skin *s;
    size_t i;
    int k;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (origin != NULL && gxp_check_vector(origin, "origin", failure) != GX_OK) return GX_ERROR_NOT_FINITE;
    if (!gxp_has_skin(body)) return gxp_fail(failure, GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    s = &body->skin;
    gxp_move_vertices(body, s->positions);
    for (i = 0; i < s->vertex_count && positions != NULL; i++)
        for (k = 0; k < 3; k++)
            positions[3 * i + (size_t)k] = (float)(s->positions[3 * i + (size_t)k] - (origin != NULL ? origin[k] : 0));
    if (normals != NULL) gxp_deformed_normals(s, normals);
    return gxp_end(failure, GX_OK);
}

/* >>tree: boxes over the deformed cells ---------------------------------------------------------------------------- */
/* In: where copies are. Out: walks through the elements whose deformed cells may be somewhere, or nearest to something.
   Touches the tree and copies.seen.
 *
 * The tree is made when somebody first asks, in the order of mesh.boxes. It is a complete binary tree. Its last level
 * are clusters of up to 64 neighbouring elements, each with GXP_TREE_LEAVES leaves of up to GXP_TREE_LEAF elements. Its
 * boxes contain the corners of all kept cells of their elements, as copies move them, and what rounding makes of points
 * between these. One pass over the copies finds those that have moved since the last refit. A cluster's box is the hull
 * of the copies of its nodes; it is found again where one of them has moved. Boxes of leaves are found again when a
 walk
 * enters the cluster. All boxes are of where the copies were seen last (copies.seen). Who looks around may walk through
 * boxes that are some slack out of date, in place of a refit.
 *
 * Cuts need no refit: a new copy is where the one is that it comes from, with the same row of copies.seen, and cells
 * only change to such copies. A rollback leaves older rows alone. The last copy, put in the place of a dead one, takes
 * its row along. */

#define GXP_TREE_LEAVES 16u
#define GXP_TREE_LEAF   4u

/* Boxes are wider than their copies' positions by this share (2^-44) of the coordinates at rest and the displacement.
   A point of the skin is the sum of 5 products of these, at most 12 roundings of each: its error is below a tenth of
   the same mean of its copies' margins. */
#define GXP_TREE_MARGIN 5.6843418860808015e-14

/* A limit that excludes nothing, and a bound above it */
#define GXP_TREE_ALL    1.797e308
#define GXP_TREE_BEYOND 1.7976931348623157e308

/* Is |x| below 2^128? Reads bits, so that it is right for what is not finite under any flag. */
static int gxp_is_near(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return ((b >> 52) & 0x7ff) < 1023 + 128;
}

static inline double gxp_more(double a, double b) { return a > b ? a : b; }

static void gxp_empty_bounds(gxp_bounds *box) {
    int k;
    for (k = 0; k < 3; k++) {
        box->low[k] = GXP_TREE_BEYOND;
        box->high[k] = -GXP_TREE_BEYOND;
    }
}

static void gxp_add_bounds(gxp_bounds *box, const gxp_bounds *other) {
    int k;
    for (k = 0; k < 3; k++) {
        box->low[k] = other->low[k] < box->low[k] ? other->low[k] : box->low[k];
        box->high[k] = other->high[k] > box->high[k] ? other->high[k] : box->high[k];
    }
}

/* The box of one copy where it was seen last, with its margin */
static void gxp_copy_bounds(const gx_body *body, uint32_t node, uint32_t copy, gxp_bounds *box) {
    const double *rest = body->mesh.positions + 3 * (size_t)node, *u = body->copies.seen + 3 * (size_t)copy;
    int k;
    for (k = 0; k < 3; k++) {
        const double x = rest[k] + u[k], margin = GXP_TREE_MARGIN * (body->tree.reach[k] + fabs(u[k]));
        box->low[k] = x - margin;
        box->high[k] = x + margin;
    }
}

/* Adds where an affine copy takes a corner of an element of its node: X_i + a + A (X - X_i). In an element positions
   are means of what its copies give, and what a copy gives is within the hull of what it gives at the corners. */
static void gxp_add_image(const gx_body *body, uint32_t copy, uint32_t corner, gxp_bounds *box) {
    gxp_bounds image;
    double way[3] = {0, 0, 0};
    int k;
    gxp_copy_bounds(body, body->copies.node[copy], copy, &image);
    gxp_add_linear(body, body->copies.linear_seen, copy, 1, body->mesh.positions + 3 * (size_t)corner, way);
    for (k = 0; k < 3; k++) {
        const double margin = GXP_TREE_MARGIN * fabs(way[k]);
        image.low[k] += way[k] - margin;
        image.high[k] += way[k] + margin;
    }
    gxp_add_bounds(box, &image);
}

/* The box of all that a copy gives: its own place, and in the elements around its node, if it is affine */
static void gxp_reach_bounds(const gx_body *body, uint32_t copy, gxp_bounds *box) {
    const uint32_t node = body->copies.node[copy];
    uint32_t i;
    int k;
    gxp_copy_bounds(body, node, copy, box);
    if (!body->copies.bends || !body->copies.affine[copy]) return;
    for (i = body->mesh.node_start[node]; i < body->mesh.node_start[node + 1]; i++)
        for (k = 0; k < 4; k++)
            gxp_add_image(body, copy, gxb_complex_element_nodes(body->complex, body->mesh.node_elements[i])[k], box);
}

/* --- making it --- */

/* The first leaves of the halves, halves of halves and so on of `leaves` leaves over the elements in mesh.box_elements,
   as gxp_build_boxes halves them */
static void gxp_divide_leaves(gx_body *body, uint32_t leaves) {
    uint32_t i, bit;
    for (i = 0; i < leaves; i++) {
        uint32_t first = 0, count = body->mesh.element_count;
        for (bit = leaves / 2; bit > 0; bit /= 2) {
            const uint32_t half = count / 2;
            if (i & bit) first += half;
            count = i & bit ? count - half : half;
        }
        body->tree.leaf_first.data[i] = first;
    }
    body->tree.leaf_first.data[leaves] = body->mesh.element_count;
    body->tree.leaf_first.count = leaves + 1;
}

/* Lists the clusters around each node. cluster: of each element */
static gx_result gxp_list_node_clusters(gx_body *body, const uint32_t *cluster) {
    gxp_tree *tree = &body->tree;
    uint32_t node, i, j;
    gx_result result = GX_OK;
    tree->node_clusters.count = 0;
    for (node = 0; node < body->mesh.node_count && result == GX_OK; node++) {
        const uint32_t first = tree->node_first.data[node] = tree->node_clusters.count;
        for (i = body->mesh.node_start[node]; i < body->mesh.node_start[node + 1] && result == GX_OK; i++) {
            const uint32_t own = cluster[body->mesh.node_elements[i]];
            for (j = first; j < tree->node_clusters.count && tree->node_clusters.data[j] != own;) j++;
            if (j == tree->node_clusters.count) result = gxp_push(body, &tree->node_clusters, own);
        }
    }
    tree->node_first.data[body->mesh.node_count] = tree->node_clusters.count;
    return result;
}

static gx_result gxp_find_node_clusters(gx_body *body, uint32_t clusters) {
    const uint32_t *first = body->tree.leaf_first.data;
    const size_t bytes = body->mesh.element_count * sizeof(uint32_t);
    uint32_t *cluster = (uint32_t *)gxp_allocate(&body->config.allocator, bytes), c, i;
    gx_result result;
    if (cluster == NULL) return GX_ERROR_MEMORY;
    for (c = 0; c < clusters; c++)
        for (i = first[c * GXP_TREE_LEAVES]; i < first[(c + 1) * GXP_TREE_LEAVES]; i++)
            cluster[body->mesh.box_elements[i]] = c;
    result = gxp_list_node_clusters(body, cluster);
    gxp_release(&body->config.allocator, cluster, bytes);
    return result;
}

/* Makes the tree; all of it is to be refitted. After an error it counts as not made. */
static GXP_COLD gx_result gxp_make_tree(gx_body *body) {
    gxp_tree *tree = &body->tree;
    const gx_allocator *a = &body->config.allocator;
    uint32_t clusters = 1, leaves, i;
    int k;
    gx_result result;
    while (body->mesh.element_count > (uint64_t)clusters * GXP_TREE_LEAVES * GXP_TREE_LEAF) clusters *= 2;
    leaves = clusters * GXP_TREE_LEAVES;
    result = gxp_grow_column(body, &gxp_copy_columns[GXP_SEEN_COLUMN], 0, body->copies.count);
    if (result == GX_OK && body->copies.affine != NULL)
        result = gxp_grow_column(body, &gxp_copy_columns[GXP_LINEAR_SEEN_COLUMN], 0, body->copies.count);
    if (result == GX_OK) result = gxp_start_words(body, &tree->leaf_first, (size_t)leaves + 1);
    if (result == GX_OK)
        result = gxp_reserve(a, &tree->leaf_boxes, sizeof *tree->leaf_boxes, 0, &tree->leaf_box_capacity, leaves);
    if (result == GX_OK)
        result = gxp_reserve(a, &tree->own_boxes, sizeof *tree->own_boxes, 0, &tree->own_box_capacity,
                             body->mesh.element_count);
    if (result == GX_OK)
        result = gxp_reserve(a, &tree->boxes, sizeof *tree->boxes, 0, &tree->box_capacity, 2 * (size_t)clusters);
    if (result == GX_OK) result = gxp_start_words(body, &tree->marks, 2 * (size_t)clusters);
    if (result == GX_OK) result = gxp_start_words(body, &tree->node_first, (size_t)body->mesh.node_count + 1);
    if (result != GX_OK) return result;
    gxp_divide_leaves(body, leaves);
    result = gxp_find_node_clusters(body, clusters);
    if (result != GX_OK) return result;
    for (k = 0; k < 3; k++) tree->reach[k] = fmax(fabs(body->mesh.boxes[0].low[k]), fabs(body->mesh.boxes[0].high[k]));
    if (body->copies.count > 0)
        memcpy(body->copies.seen, body->copies.displacement, 3 * (size_t)body->copies.count * sizeof(double));
    if (body->copies.count > 0 && body->copies.affine != NULL)
        memcpy(body->copies.linear_seen, body->copies.linear, 9 * (size_t)body->copies.count * sizeof(double));
    for (i = 0; i < 2 * clusters - 1; i++) tree->marks.data[i] = GXP_BOX_MOVED;
    tree->marks.count = 2 * clusters - 1;
    tree->cluster_count = clusters;
    return GX_OK;
}

/* --- refitting it --- */

/* Marks the clusters around nodes whose copies have moved. Returns whether any have. */
static int gxp_mark_moved(gx_body *body) {
    gxp_tree *tree = &body->tree;
    uint32_t *marks = tree->marks.data + tree->cluster_count - 1;
    double *seen = body->copies.seen;
    const double *u = body->copies.displacement;
    uint32_t i, j;
    int moved = 0;
    for (i = 0; i < body->copies.count; i++, u += 3, seen += 3) {
        const uint32_t node = body->copies.node[i];
        const int bends = body->copies.bends && body->copies.affine[i];
        const double *a = bends ? body->copies.linear + 9 * (size_t)i : NULL;
        double *seen_a = bends ? body->copies.linear_seen + 9 * (size_t)i : NULL;
        if (memcmp(u, seen, 3 * sizeof *u) == 0 && !(bends && memcmp(a, seen_a, 9 * sizeof *a) != 0)) continue;
        memcpy(seen, u, 3 * sizeof *u);
        if (bends) memcpy(seen_a, a, 9 * sizeof *a);
        moved = 1;
        for (j = tree->node_first.data[node]; j < tree->node_first.data[node + 1]; j++)
            marks[tree->node_clusters.data[j]] |= GXP_BOX_MOVED;
    }
    return moved;
}

/* Finds the boxes of marked clusters: the hulls of the copies of their nodes. */
static void gxp_fit_clusters(gx_body *body) {
    gxp_tree *tree = &body->tree;
    const uint32_t *marks = tree->marks.data + tree->cluster_count - 1;
    gxp_bounds *boxes = tree->boxes + tree->cluster_count - 1;
    uint32_t i, j;
    int k;
    for (i = 0; i < tree->cluster_count; i++)
        if (marks[i] & GXP_BOX_MOVED) gxp_empty_bounds(&boxes[i]);
    tree->wild = 0;
    for (i = 0; i < body->copies.count; i++) {
        const uint32_t node = body->copies.node[i];
        gxp_bounds own;
        gxp_reach_bounds(body, i, &own);
        for (k = 0; k < 3; k++) tree->wild |= !gxp_is_near(own.low[k]) || !gxp_is_near(own.high[k]);
        for (j = tree->node_first.data[node]; j < tree->node_first.data[node + 1]; j++)
            if (marks[tree->node_clusters.data[j]] & GXP_BOX_MOVED)
                gxp_add_bounds(&boxes[tree->node_clusters.data[j]], &own);
    }
}

/* Finds the boxes above moved ones, and makes leaves' boxes in moved clusters stale. */
static void gxp_fit_above(gxp_tree *tree) {
    uint32_t *marks = tree->marks.data, i;
    for (i = tree->cluster_count - 1; i-- > 0;) {
        if (!((marks[2 * i + 1] | marks[2 * i + 2]) & GXP_BOX_MOVED)) continue;
        tree->boxes[i] = tree->boxes[2 * i + 1];
        gxp_add_bounds(&tree->boxes[i], &tree->boxes[2 * i + 2]);
        marks[i] |= GXP_BOX_MOVED;
    }
    for (i = 0; i < 2 * tree->cluster_count - 1; i++)
        if (marks[i] & GXP_BOX_MOVED) marks[i] = GXP_BOX_STALE;
}

/* Brings the boxes of clusters and above up to date: one pass over the copies, more where any have moved. Call it
   before a walk whenever displacements may have changed. Errors: MEMORY, LIMIT. */
static gx_result gxp_refit_tree(gx_body *body) {
    gx_result result = GX_OK;
    int moved = body->tree.cluster_count == 0;
    if (moved)
        result = gxp_make_tree(body);
    else
        moved = gxp_mark_moved(body);
    if (result != GX_OK || !moved) return result;
    gxp_fit_clusters(body);
    gxp_fit_above(&body->tree);
    return GX_OK;
}

/* How far copies have moved since they were seen last: the largest coordinate, HUGE_VAL if one is not finite. Sums show
   what is not finite, which comparisons may not. */
static double gxp_drift(const gx_body *body) {
    const double *u = body->copies.displacement, *seen = body->copies.seen;
    double most[3] = {0, 0, 0}, sum[3] = {0, 0, 0};
    uint32_t i;
    int k;
    for (i = 0; i < body->copies.count; i++, u += 3, seen += 3)
        for (k = 0; k < 3; k++) {
            const double way = fabs(u[k] - seen[k]);
            most[k] = gxp_more(way, most[k]);
            sum[k] += way;
        }
    return gxp_is_finite(sum[0] + sum[1] + sum[2]) ? gxp_more(most[0], gxp_more(most[1], most[2])) : HUGE_VAL;
}

/* Brings the boxes up to date where copies have moved farther than `most`. *slack: cells are at most so far outside of
   their boxes. One pass over the copies. Errors: MEMORY, LIMIT. */
static gx_result gxp_refit_loosely(gx_body *body, double most, double *slack) {
    *slack = body->tree.cluster_count > 0 ? gxp_drift(body) * (1 + GXP_TREE_MARGIN) : HUGE_VAL;
    if (*slack <= most) return GX_OK;
    *slack = 0;
    return gxp_refit_tree(body);
}

/* A copy that is out of range or not finite, GXP_NONE: there is none. The boxes are up to date. */
static uint32_t gxp_wild_copy(gx_body *body) {
    uint32_t i;
    int k;
    if (!body->tree.wild) return GXP_NONE;
    for (i = 0; i < body->copies.count; i++) {
        gxp_bounds own;
        gxp_reach_bounds(body, i, &own);
        for (k = 0; k < 3; k++)
            if (!gxp_is_near(own.low[k]) || !gxp_is_near(own.high[k])) return i;
    }
    body->tree.wild = 0; /* a cut has removed it since */
    return GXP_NONE;
}

/* The box of all kept cells of an element */
static void gxp_fit_element(const gx_body *body, uint32_t element, gxp_bounds *box) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, element);
    gxp_bounds own;
    uint32_t cell;
    int k, n;
    gxp_empty_bounds(box);
    for (cell = element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        for (k = 0; k < 4 && body->cells.data[cell].kept; k++) {
            const uint32_t copy = body->cells.data[cell].copies[k];
            gxp_copy_bounds(body, node[k], copy, &own);
            gxp_add_bounds(box, &own);
            for (n = 0; n < 4 && body->copies.bends && body->copies.affine[copy]; n++)
                gxp_add_image(body, copy, node[n], box);
        }
}

/* Finds the boxes of a cluster's elements and leaves, and its own, which is now that of its cells. */
static void gxp_fit_leaves(gx_body *body, uint32_t cluster) {
    gxp_tree *tree = &body->tree;
    gxp_bounds *all = &tree->boxes[tree->cluster_count - 1 + cluster];
    uint32_t i, e;
    gxp_empty_bounds(all);
    for (i = cluster * GXP_TREE_LEAVES; i < (cluster + 1) * GXP_TREE_LEAVES; i++) {
        gxp_empty_bounds(&tree->leaf_boxes[i]);
        for (e = tree->leaf_first.data[i]; e < tree->leaf_first.data[i + 1]; e++) {
            gxp_fit_element(body, body->mesh.box_elements[e], &tree->own_boxes[e]);
            gxp_add_bounds(&tree->leaf_boxes[i], &tree->own_boxes[e]);
        }
        gxp_add_bounds(all, &tree->leaf_boxes[i]);
    }
    tree->marks.data[tree->cluster_count - 1 + cluster] &= ~(uint32_t)GXP_BOX_STALE;
}

/* --- walking through it --- */

/* Above 0 where the boxes do not meet */
static inline double gxp_gap(const gxp_bounds *a, const gxp_bounds *b) {
    const double x = gxp_more(a->low[0] - b->high[0], b->low[0] - a->high[0]),
                 y = gxp_more(a->low[1] - b->high[1], b->low[1] - a->high[1]),
                 z = gxp_more(a->low[2] - b->high[2], b->low[2] - a->high[2]);
    return gxp_more(x, gxp_more(y, z));
}

static gx_result gxp_meet_cluster(gx_body *body, const gxp_bounds *given, uint32_t cluster,
                                  gx_result (*visit)(gx_body *body, void *user, uint32_t place), void *user) {
    const gxp_tree *tree = &body->tree;
    const uint32_t first = cluster * GXP_TREE_LEAVES;
    const gxp_bounds box = *given; /* in registers */
    uint32_t i, e;
    gx_result result = GX_OK;
    if (tree->marks.data[tree->cluster_count - 1 + cluster] & GXP_BOX_STALE) gxp_fit_leaves(body, cluster);
    for (i = first; i < first + GXP_TREE_LEAVES && result == GX_OK; i++) {
        if (gxp_gap(&tree->leaf_boxes[i], &box) > 0) continue;
        for (e = tree->leaf_first.data[i]; e < tree->leaf_first.data[i + 1] && result == GX_OK; e++)
            if (!(gxp_gap(&tree->own_boxes[e], &box) > 0)) result = visit(body, user, e);
    }
    return result;
}

/* Calls visit(body, user, place) for each element whose box meets a box; place: in mesh.box_elements. */
static gx_result gxp_meet_box(gx_body *body, const gxp_bounds *given,
                              gx_result (*visit)(gx_body *body, void *user, uint32_t place), void *user) {
    const gxp_tree *tree = &body->tree;
    const uint32_t first_cluster = tree->cluster_count - 1;
    const gxp_bounds box = *given;
    uint32_t stack[64], depth = 0;
    gx_result result = GX_OK;
    if (!(gxp_gap(&tree->boxes[0], &box) > 0)) stack[depth++] = 0;
    while (depth > 0 && result == GX_OK) {
        const uint32_t i = stack[--depth];
        if (i >= first_cluster)
            result = gxp_meet_cluster(body, given, i - first_cluster, visit, user);
        else {
            stack[depth] = 2 * i + 1;
            depth += !(gxp_gap(&tree->boxes[2 * i + 1], &box) > 0);
            stack[depth] = 2 * i + 2;
            depth += !(gxp_gap(&tree->boxes[2 * i + 2], &box) > 0);
        }
    }
    return result;
}

/* A walk with many boxes at once: each box of the tree passes on those that it meets. Callers put it first in a struct
   of their own. */
typedef struct gxp_boxes_walk {
    /* Called for each element whose box meets some of the boxes, within the slack: `count` of them, ascending. place:
       in mesh.box_elements. Elements come in an order that is always the same. */
    gx_result (*visit)(gx_body *body, struct gxp_boxes_walk *walk, uint32_t place, const uint32_t *met, uint32_t count);
    const gxp_bounds *boxes;
    double slack; /* as gxp_refit_loosely gave it */
} gxp_boxes_walk;

/* Appends to tree.met those of its last `count` boxes that meet a box of the tree. Returns their number; there is room.
 */
static uint32_t gxp_pass_met(gxp_tree *tree, const gxp_boxes_walk *walk, const gxp_bounds *box, uint32_t count) {
    const uint32_t *from = tree->met.data + tree->met.count - count;
    uint32_t *to = tree->met.data + tree->met.count, n = 0, i;
    for (i = 0; i < count; i++) {
        to[n] = from[i];
        n += !(gxp_gap(&walk->boxes[from[i]], box) > walk->slack);
    }
    tree->met.count += n;
    return n;
}

static gx_result gxp_meet_boxes_in_cluster(gx_body *body, gxp_boxes_walk *walk, uint32_t cluster, uint32_t count) {
    gxp_tree *tree = &body->tree;
    const uint32_t first = cluster * GXP_TREE_LEAVES;
    uint32_t i, e;
    gx_result result = GX_OK;
    if (tree->marks.data[tree->cluster_count - 1 + cluster] & GXP_BOX_STALE) gxp_fit_leaves(body, cluster);
    for (i = first; i < first + GXP_TREE_LEAVES && result == GX_OK; i++) {
        const uint32_t in_leaf = gxp_pass_met(tree, walk, &tree->leaf_boxes[i], count);
        for (e = tree->leaf_first.data[i]; e < tree->leaf_first.data[i + 1] && in_leaf > 0 && result == GX_OK; e++) {
            const uint32_t met = gxp_pass_met(tree, walk, &tree->own_boxes[e], in_leaf);
            if (met > 0) result = walk->visit(body, walk, e, tree->met.data + tree->met.count - met, met);
            tree->met.count -= met;
        }
        tree->met.count -= in_leaf;
    }
    return result;
}

/* The part of the walk below a box of the tree, which meets the last `count` boxes of tree.met */
static gx_result gxp_meet_boxes_below(gx_body *body, gxp_boxes_walk *walk, uint32_t box, uint32_t count) {
    gxp_tree *tree = &body->tree;
    uint32_t half;
    gx_result result = GX_OK;
    if (box >= tree->cluster_count - 1)
        return gxp_meet_boxes_in_cluster(body, walk, box - (tree->cluster_count - 1), count);
    for (half = 2; half > 0 && result == GX_OK; half--) {
        const uint32_t met = gxp_pass_met(tree, walk, &tree->boxes[2 * box + half], count);
        if (met > 0) result = gxp_meet_boxes_below(body, walk, 2 * box + half, met);
        tree->met.count -= met;
    }
    return result;
}

static gx_result gxp_meet_boxes(gx_body *body, gxp_boxes_walk *walk, uint32_t count) {
    gxp_tree *tree = &body->tree;
    size_t levels = 4; /* the boxes, those of the root, a leaf's, an element's */
    uint32_t i, met;
    gx_result result;
    for (i = 1; i < tree->cluster_count; i *= 2) levels++;
    result = gxp_start_words(body, &tree->met, levels * count);
    if (result != GX_OK) return result;
    for (i = 0; i < count; i++) tree->met.data[i] = i;
    tree->met.count = count;
    met = gxp_pass_met(tree, walk, &tree->boxes[0], count);
    return met > 0 ? gxp_meet_boxes_below(body, walk, 0, met) : GX_OK;
}

/* A walk to what is least by a measure. Callers put it first in a struct of their own. */
typedef struct gxp_walk {
    /* No less than this comes of what is in the box. Above limit, or GXP_TREE_BEYOND: nothing there counts */
    double (*bound)(const struct gxp_walk *walk, const gxp_bounds *box);
    /* Called for each element in a leaf whose bound is no more than limit */
    gx_result (*visit)(gx_body *body, struct gxp_walk *walk, uint32_t element);
    double limit; /* GXP_TREE_ALL, or less; visit may lower it */
} gxp_walk;

/* Visits a cluster's leaves, those with the least bounds first. */
static gx_result gxp_walk_cluster(gx_body *body, gxp_walk *walk, uint32_t cluster) {
    const gxp_tree *tree = &body->tree;
    const uint32_t first = cluster * GXP_TREE_LEAVES;
    double bound[GXP_TREE_LEAVES];
    uint32_t i, e;
    gx_result result = GX_OK;
    if (tree->marks.data[tree->cluster_count - 1 + cluster] & GXP_BOX_STALE) gxp_fit_leaves(body, cluster);
    for (i = 0; i < GXP_TREE_LEAVES; i++) bound[i] = walk->bound(walk, &tree->leaf_boxes[first + i]);
    while (result == GX_OK) {
        uint32_t least = 0;
        for (i = 1; i < GXP_TREE_LEAVES; i++)
            if (bound[i] < bound[least]) least = i;
        if (!(bound[least] <= walk->limit)) break;
        bound[least] = GXP_TREE_BEYOND;
        for (e = tree->leaf_first.data[first + least]; e < tree->leaf_first.data[first + least + 1] && result == GX_OK;
             e++)
            if (walk->bound(walk, &tree->own_boxes[e]) <= walk->limit)
                result = walk->visit(body, walk, body->mesh.box_elements[e]);
    }
    return result;
}

/* Walks through the tree, of two boxes first to the one with the lower bound. What the walk finds depends on the order
   only if visit or bound does. */
static gx_result gxp_walk_tree(gx_body *body, gxp_walk *walk) {
    const gxp_tree *tree = &body->tree;
    const uint32_t first_cluster = tree->cluster_count - 1;
    uint32_t stack[64], depth = 0, i;
    double bounds[64];
    gx_result result = GX_OK;
    stack[depth] = 0;
    bounds[depth++] = walk->bound(walk, &tree->boxes[0]);
    while (depth > 0 && result == GX_OK) {
        i = stack[--depth];
        if (!(bounds[depth] <= walk->limit)) continue;
        if (i >= first_cluster)
            result = gxp_walk_cluster(body, walk, i - first_cluster);
        else {
            const double left = walk->bound(walk, &tree->boxes[2 * i + 1]),
                         right = walk->bound(walk, &tree->boxes[2 * i + 2]);
            const uint32_t nearer = right < left;
            stack[depth] = 2 * i + 2 - nearer;
            bounds[depth++] = nearer ? left : right;
            stack[depth] = 2 * i + 1 + nearer;
            bounds[depth++] = nearer ? right : left;
        }
    }
    return result;
}

/* >>locate: cells at points of space, and their maps --------------------------------------------------------------- */
/* In: points of space, material points, boxes. Out: the cells that contain a point, exactly; those whose deformed
   elements a box meets; material points, weights, positions. The tree is up to date (gxp_refit_tree) where cells are
   sought. Touches lists that are given, and the complex's exact numbers.
 *
 * Other sections may use gxp_walk_box, gxp_find_cells_at, gxp_contains_point, gxp_pull_back, gxp_image, gxp_stretch. */

/* --- cells by their deformed elements --- */

/* The box of a cell's deformed element */
static void gxp_cell_bounds(const gx_body *body, uint32_t element, const gxp_cell *cell, gxp_bounds *box) {
    const uint32_t *node = gxb_complex_element_nodes(body->complex, element);
    double x[12];
    int n, k;
    gxp_moved_corners(body, cell, x);
    gxp_empty_bounds(box);
    for (n = 0; n < 4; n++)
        for (k = 0; k < 3; k++) {
            box->low[k] = x[3 * n + k] < box->low[k] ? x[3 * n + k] : box->low[k];
            box->high[k] = x[3 * n + k] > box->high[k] ? x[3 * n + k] : box->high[k];
        }
    for (n = 0; n < 4 && body->copies.bends; n++)
        for (k = 0; k < 4 && body->copies.affine[cell->copies[n]]; k++)
            gxp_add_image(body, cell->copies[n], node[k], box);
}

typedef struct gxp_box_walk {
    gxp_bounds box;
    gx_result (*visit)(gx_body *body, void *user, uint32_t cell);
    void *user;
} gxp_box_walk;

static inline gx_result gxp_visit_in_box(gx_body *body, void *user, uint32_t place) {
    const gxp_box_walk *walk = (const gxp_box_walk *)user;
    uint32_t cell;
    gx_result result = GX_OK;
    for (cell = body->mesh.box_elements[place]; cell != GXP_NONE && result == GX_OK;
         cell = body->cells.data[cell].next) {
        gxp_bounds box;
        if (!body->cells.data[cell].kept) continue;
        gxp_cell_bounds(body, body->mesh.box_elements[place], &body->cells.data[cell], &box);
        if (!(gxp_gap(&box, &walk->box) > 0)) result = walk->visit(body, walk->user, cell);
    }
    return result;
}

/* Calls visit(body, user, cell) for each kept cell whose deformed element's box meets the box, once. visit must not
   change cells. The walk ends with the first error. */
static gx_result gxp_walk_box(gx_body *body, const gxp_bounds *box,
                              gx_result (*visit)(gx_body *body, void *user, uint32_t cell), void *user) {
    gxp_box_walk walk;
    walk.box = *box;
    walk.visit = visit;
    walk.user = user;
    return gxp_meet_box(body, box, gxp_visit_in_box, &walk);
}

/* Is a leaf of the cell among those below a reference to its element's tree to which the planes lead the pulled-back
   point? From a plane that contains it both sides are followed. */
static int gxp_leads_to(gx_body *body, gxb_pullback *back, uint32_t reference, uint32_t cell) {
    const uint32_t element = body->cells.data[cell].element;
    while (reference & 1) {
        const gxb_node *node = gxb_complex_tree_node(body->complex, reference >> 1);
        const int side = gxb_complex_pullback_side(body->complex, back, element, node->plane);
        if (side == 0 && gxp_leads_to(body, back, node->child[0], cell)) return 1;
        reference = node->child[side <= 0];
    }
    return gxp_is_kept(body, reference >> 1) && body->leaves.data[reference >> 1].cell == cell;
}

/* The material point with these barycentric coordinates; exactly a node, or in a coordinate plane, where they say so */
static void gxp_weigh_material(const double rest[12], const double weights[4], double material[3]) {
    int n, k, most = 0;
    for (n = 1; n < 4; n++)
        if (fabs(weights[n]) > fabs(weights[most])) most = n;
    for (k = 0; k < 3; k++) {
        double sum = 0;
        for (n = 0; n < 4; n++) sum += weights[n] * (rest[3 * n + k] - rest[3 * most + k]);
        material[k] = rest[3 * most + k] + sum;
    }
}

/* Steps of Newton's method, which doubles the digits with each; a step below this share of the element is the last. */
#define GXP_UNBEND_STEPS 24
#define GXP_UNBEND_SMALL 1.4210854715202004e-14

/* How far a bent cell's map is from a point at barycentric coordinates, and its derivatives by the last three of these.
   The map is sum of N_i (X_i + a_i + A_i (X - X_i)). */
static void gxp_bent_residual(const gx_body *body, const gxp_cell *c, const double rest[12], const double weights[4],
                              const double material[3], const double point[3], double off[3], double slope[3][3]) {
    double image[4][3];
    int n, i, k;
    memset(slope, 0, 9 * sizeof slope[0][0]);
    memset(image, 0, sizeof image);
    for (n = 0; n < 4; n++) {
        const double *u = body->copies.displacement + 3 * (size_t)c->copies[n], *own = rest + 3 * n;
        if (body->copies.affine[c->copies[n]]) {
            gxp_add_linear(body, body->copies.linear, c->copies[n], 1, material, image[n]);
            for (i = 0; i < 3; i++) { /* A by the way from corner 0 to corner i + 1, added to its column */
                const double way[3] = {own[0] + rest[3 * i + 3] - rest[0], own[1] + rest[3 * i + 4] - rest[1],
                                       own[2] + rest[3 * i + 5] - rest[2]};
                gxp_add_linear(body, body->copies.linear, c->copies[n], weights[n], way, slope[i]);
            }
        }
        for (k = 0; k < 3; k++) image[n][k] += own[k] + u[k];
    }
    for (k = 0; k < 3; k++) {
        off[k] = weights[0] * (image[0][k] - point[k]);
        for (i = 0; i < 3; i++) {
            off[k] += weights[i + 1] * (image[i + 1][k] - point[k]);
            slope[i][k] += image[i + 1][k] - image[0][k];
        }
    }
}

/* Pulls a point of space back by the map of a bent cell, to rounding, from coordinates to begin with. 0: it is nowhere
   near there. */
static int gxp_unbend(const gx_body *body, const gxp_cell *c, const double point[3], double weights[4],
                      double material[3]) {
    double rest[12], off[3], slope[3][3], normal[3][3];
    int step, i;
    gxp_element_positions(body, c->element, rest);
    for (step = 0; step < GXP_UNBEND_STEPS; step++) {
        double volume, most = 0;
        gxp_weigh_material(rest, weights, material);
        gxp_bent_residual(body, c, rest, weights, material, point, off, slope);
        for (i = 0; i < 3; i++) gxp_cross(normal[i], slope[(i + 1) % 3], slope[(i + 2) % 3]);
        volume = gxp_dot(slope[0], normal[0]);
        if (!(fabs(volume) > 0)) return 0;
        for (i = 0; i < 3; i++) {
            const double change = -gxp_dot(off, normal[i]) / volume;
            weights[i + 1] += change;
            most = fmax(most, fabs(change));
        }
        weights[0] = 1 - weights[1] - weights[2] - weights[3];
        if (!(most < 1e3)) return 0;
        if (most < GXP_UNBEND_SMALL) {
            gxp_weigh_material(rest, weights, material);
            return 1;
        }
    }
    return 0;
}

/* Pulls a point of space back by the map of a bent cell that contains it: coordinates and material point. 0: none was
   found in the cell. Begins at the place that the cell's corners alone would give the point, then in the middle. */
static int gxp_find_in_bent(gx_body *body, uint32_t cell, const double point[3], double weights[4],
                            double material[3]) {
    const gxp_cell *c = &body->cells.data[cell];
    gxb_pullback back;
    double x[12], rest[12];
    int from, n;
    gxp_element_positions(body, c->element, rest);
    for (from = 0; from < 2; from++) {
        gxp_moved_corners(body, c, x);
        gxb_pullback_set(&back, x, point);
        if (from == 0 && (gxb_pullback_contains(&back) || gxb_pullback_orient(&back) != 0))
            gxb_pullback_weights(&back, weights);
        else
            for (n = 0; n < 4; n++) weights[n] = 0.25;
        if (!gxp_unbend(body, c, point, weights, material)) continue;
        if (gxb_pullback_misses(rest, material)) continue;
        gxb_pullback_set(&back, rest, material);
        if (gxb_pullback_contains(&back) &&
            gxp_leads_to(body, &back, gxb_complex_root(body->complex, c->element), cell))
            return 1;
    }
    return 0;
}

/* Does the cell, or its boundary, contain a point of space? Exact for the corners that gxp_moved_corners gives; a bent
   cell contains what it contains at rest once rounded there. */
static int gxp_contains_point(gx_body *body, uint32_t cell, const double point[3]) {
    const gxp_cell *c = &body->cells.data[cell];
    gxb_pullback back;
    double x[12], weights[4], material[3];
    if (gxp_is_bent(body, c)) return gxp_find_in_bent(body, cell, point, weights, material);
    gxp_moved_corners(body, c, x);
    if (gxb_pullback_misses(x, point)) return 0;
    gxb_pullback_set(&back, x, point);
    return gxb_pullback_contains(&back) && gxp_leads_to(body, &back, gxb_complex_root(body->complex, c->element), cell);
}

typedef struct gxp_point_walk {
    const double *point;
    gxp_words *cells;
} gxp_point_walk;

/* Adds a cell to an ascending list. */
static gx_result gxp_push_in_order(gx_body *body, gxp_words *cells, uint32_t cell) {
    uint32_t i = cells->count;
    const gx_result result = gxp_push(body, cells, cell);
    if (result != GX_OK) return result;
    for (; i > 0 && cells->data[i - 1] > cell; i--) cells->data[i] = cells->data[i - 1];
    cells->data[i] = cell;
    return GX_OK;
}

static gx_result gxp_visit_at_point(gx_body *body, void *user, uint32_t place) {
    const gxp_point_walk *walk = (const gxp_point_walk *)user;
    uint32_t cell;
    gx_result result = GX_OK;
    for (cell = body->mesh.box_elements[place]; cell != GXP_NONE && result == GX_OK; cell = body->cells.data[cell].next)
        if (body->cells.data[cell].kept && gxp_contains_point(body, cell, walk->point))
            result = gxp_push_in_order(body, walk->cells, cell);
    return result;
}

/* Lists the cells that contain a point of space, or have it on their boundary, ascending. point: finite */
static gx_result gxp_find_cells_at(gx_body *body, const double point[3], gxp_words *cells) {
    gxp_point_walk walk;
    gxp_bounds box;
    memcpy(box.low, point, sizeof box.low);
    memcpy(box.high, point, sizeof box.high);
    walk.point = point;
    walk.cells = cells;
    cells->count = 0;
    return gxp_meet_box(body, &box, gxp_visit_at_point, &walk);
}

/* --- the maps of a cell --- */

/* Outside of its element, the map of a bent cell goes on as the affine map that touches it next to there: at the same
   coordinates with those below 0 left out. So it has no folds of its own where nothing is. */
static void gxp_touch_bent(const gx_body *body, const gxp_cell *c, const double weights[4], const double point[3],
                           double inside[4], double off[3], double slope[3][3]) {
    double rest[12], material[3], sum = 0;
    int n;
    for (n = 0; n < 4; n++) sum += inside[n] = fmax(weights[n], 0);
    for (n = 0; n < 4; n++) inside[n] /= sum;
    gxp_element_positions(body, c->element, rest);
    gxp_weigh_material(rest, inside, material);
    gxp_bent_residual(body, c, rest, inside, material, point, off, slope);
}

/* Where a bent cell's map has a place, also outside of its element. weights: 1 in sum */
static void gxp_image_of_bent(const gx_body *body, const gxp_cell *c, const double weights[4], double x[3]) {
    static const double origin[3] = {0, 0, 0};
    double inside[4], slope[3][3];
    int i, k;
    gxp_touch_bent(body, c, weights, origin, inside, x, slope);
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) x[k] += (weights[i + 1] - inside[i + 1]) * slope[i][k];
}

/* The place that a bent cell's map has at a point of space, also outside of its element: in doubles, by Newton's
   method. Where that finds none, the place by the last map that touches. 0: there is none, the cell is flat. */
static int gxp_place_in_bent(const gx_body *body, const gxp_cell *c, const double point[3], double weights[4]) {
    double inside[4], off[3], slope[3][3], normal[3][3];
    int step, i;
    for (i = 0; i < 4; i++) weights[i] = 0.25;
    for (step = 0; step < GXP_UNBEND_STEPS; step++) {
        double volume, most = 0;
        gxp_touch_bent(body, c, weights, point, inside, off, slope);
        for (i = 0; i < 3; i++) gxp_cross(normal[i], slope[(i + 1) % 3], slope[(i + 2) % 3]);
        volume = gxp_dot(slope[0], normal[0]);
        if (!(fabs(volume) > 0)) return 0;
        for (i = 1; i < 4; i++) {
            const double next = inside[i] - gxp_dot(off, normal[i - 1]) / volume;
            most = fmax(most, fabs(next - weights[i]));
            weights[i] = next;
        }
        weights[0] = 1 - weights[1] - weights[2] - weights[3];
        if (!(most > GXP_UNBEND_SMALL) || !(most < 1e9)) break;
    }
    return gxp_is_finite(weights[0]);
}

/* Pulls a point of space back by the map of a cell's deformed element, also from outside of it. weights: of the cell's
   copies, 1 in sum. At rest the material point is the point, bit by bit, unless the cell is bent. 0: the element is
   flat. */
static int gxp_pull_back(const gx_body *body, uint32_t cell, const double point[3], double weights[4],
                         double material[3]) {
    const gxp_cell *c = &body->cells.data[cell];
    gxb_pullback back;
    double x[12], rest[12];
    int i, still = 1;
    if (gxp_is_bent(body, c)) {
        if (!gxp_place_in_bent(body, c, point, weights)) return 0;
        gxp_element_positions(body, c->element, rest);
        gxp_weigh_material(rest, weights, material);
        return 1;
    }
    gxp_moved_corners(body, c, x);
    gxp_element_positions(body, c->element, rest);
    gxb_pullback_set(&back, x, point);
    if (!gxb_pullback_contains(&back) && gxb_pullback_orient(&back) == 0) return 0;
    gxb_pullback_weights(&back, weights);
    for (i = 0; i < 12; i++) still = still && !(x[i] < rest[i]) && !(x[i] > rest[i]);
    if (still)
        memcpy(material, point, 3 * sizeof *material);
    else
        gxp_weigh_material(rest, weights, material);
    return 1;
}

/* Where a cell has a material point, also from outside of its element */
static void gxp_image(const gx_body *body, uint32_t cell, const double material[3], double position[3]) {
    const gxp_cell *c = &body->cells.data[cell];
    gxb_pullback back;
    double rest[12], weights[4];
    gxp_element_positions(body, c->element, rest);
    gxb_pullback_set(&back, rest, material);
    (void)gxb_pullback_contains(&back);
    gxb_pullback_weights(&back, weights);
    gxp_map_affine(body, c, weights, material, position);
}

/* The volume of a cell's deformed element as a share of that at rest, below 0 where it is inverted; in doubles. Of a
   bent cell that of the map which touches in the middle. */
static double gxp_stretch(const gx_body *body, uint32_t cell) {
    static const double middle[4] = {0.25, 0.25, 0.25, 0.25}, origin[3] = {0, 0, 0};
    const gxp_cell *c = &body->cells.data[cell];
    double x[12];
    if (gxp_is_bent(body, c)) {
        double inside[4], off[3], slope[3][3], normal[3];
        gxp_touch_bent(body, c, middle, origin, inside, off, slope);
        gxp_cross(normal, slope[1], slope[2]);
        return gxp_dot(slope[0], normal) / (6 * gxp_element_volume(body, c->element));
    }
    gxp_moved_corners(body, c, x);
    return gxi_tet_volume(x) / gxp_element_volume(body, c->element);
}

/* >>nearest: the cell that is nearest to a point of space ---------------------------------------------------------- */
/* In: a point that lies in no cell that counts. Out: the nearest point of the deformed surface of those cells, in
   doubles. The tree is up to date. Touches the boundary of >>integrals and the complex's lists. Other sections may use
   gxp_find_nearest. */

/* The point of a cell's deformed material that is nearest to a point of space outside of it */
typedef struct gxp_near {
    uint32_t cell;     /* GXP_NONE: there is none */
    double square;     /* of the distance */
    double weights[4]; /* of the cell's copies: 0 or more, 1 in sum */
} gxp_near;

typedef struct gxp_near_walk {
    gxp_walk walk;
    const double *point;
    int (*admits)(void *user, uint32_t cell); /* NULL: all cells are admitted */
    void *user;
    gxp_near near;
} gxp_near_walk;

/* Rounding of bounds and squares stays below this share of them. */
#define GXP_NEAR_MARGIN 1e-12

static double gxp_bound_distance(const gxp_walk *walk, const gxp_bounds *box) {
    const double *x = ((const gxp_near_walk *)(const void *)walk)->point;
    double square = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const double below = box->low[k] - x[k], above = x[k] - box->high[k], most = below > above ? below : above;
        if (most > 0) square += most * most;
    }
    return square * (1 - GXP_NEAR_MARGIN);
}

/* Rounding of what follows is far below this share (2^-46) of the sizes of the terms. */
#define GXP_NEAR_ROUNDING 1.4210854715202004e-14

/* If a point of the segment from corner i to corner j is nearer to the origin than *square: sets that and the shares.
 */
static void gxp_near_segment(double p[3][3], int i, int j, double share[3], double *square) {
    const double *a = p[i], *b = p[j];
    const double e[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double length = gxp_dot(e, e), along = -gxp_dot(a, e);
    const double t = !(along > 0) ? 0 : along >= length ? 1 : along / length;
    const double x[3] = {t < 1 ? a[0] + t * e[0] : b[0], t < 1 ? a[1] + t * e[1] : b[1],
                         t < 1 ? a[2] + t * e[2] : b[2]};
    const double s = gxp_dot(x, x);
    if (!(s < *square)) return;
    *square = s;
    share[0] = share[1] = share[2] = 0;
    share[i] = 1 - t;
    share[j] = t;
}

/* The foot of the perpendicular from the origin, if it is nearer; all w are above 0 */
static void gxp_near_foot(double p[3][3], const double w[3], double share[3], double *square) {
    const double sum = w[0] + w[1] + w[2];
    double x[3], s;
    int k;
    for (k = 0; k < 3; k++) x[k] = (w[0] * p[0][k] + w[1] * p[1][k] + w[2] * p[2][k]) / sum;
    s = gxp_dot(x, x);
    if (!(s < *square)) return;
    *square = s;
    for (k = 0; k < 3; k++) share[k] = w[k] / sum;
}

/* Finds the point of a triangle that is nearest to the origin, as shares of its corners. Returns the square of its
   distance; GXP_TREE_BEYOND if the triangle's plane is certainly further than limit. With v = -p0, a = p1 - p0, b = p2
   - p0 and n = a x b, the foot of the perpendicular has the coordinates n.(v x b) and n.(a x v), over n.n. If it is
   beyond some edges, the nearest point is on one of these. Edges are tried wherever rounding might hide that. */
static double gxp_near_triangle(double p[3][3], double limit, double share[3]) {
    const double a[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
    const double b[3] = {p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
    const double v[3] = {-p[0][0], -p[0][1], -p[0][2]};
    const double scale = gxp_size(a) * gxp_size(b), far = gxp_size(v);
    double n[3], c[3], w[3], normal, height, rounding, square = GXP_TREE_BEYOND;
    int i;
    gxp_cross(n, a, b);
    normal = gxp_dot(n, n);
    height = fabs(gxp_dot(n, v)) - GXP_NEAR_ROUNDING * scale * far;
    if (height > 0 && height * height * (1 - GXP_NEAR_MARGIN) > limit * normal) return square;
    gxp_cross(c, v, b);
    w[1] = gxp_dot(n, c);
    gxp_cross(c, a, v);
    w[2] = gxp_dot(n, c);
    w[0] = normal - w[1] - w[2];
    rounding = GXP_NEAR_ROUNDING * scale * (scale + far * (gxp_size(a) + gxp_size(b)));
    for (i = 0; i < 3; i++)
        if (!(w[i] > rounding)) gxp_near_segment(p, (i + 1) % 3, (i + 2) % 3, share, &square);
    if (w[0] > 0 && w[1] > 0 && w[2] > 0) gxp_near_foot(p, w, share, &square);
    return square;
}

/* Compares the nearest point of a triangle with what was found before. p: its corners less the point; lambda: their
   coordinates in the cell's element. Of equally near cells the first one stays. */
static void gxp_try_triangle(gxp_near_walk *own, uint32_t cell, double p[3][3], const double *const lambda[3]) {
    double share[3] = {0, 0, 0};
    const double square = gxp_near_triangle(p, own->walk.limit, share);
    int n;
    if (square > own->walk.limit ||
        (own->near.cell != GXP_NONE && !(square < own->walk.limit) && cell >= own->near.cell))
        return;
    own->near.cell = cell;
    own->near.square = own->walk.limit = square;
    for (n = 0; n < 4; n++)
        own->near.weights[n] = share[0] * lambda[0][n] + share[1] * lambda[1][n] + share[2] * lambda[2][n];
}

/* Is the origin certainly on the side of the triangle on which x is? */
static int gxp_is_beside(double p[3][3], const double x[3]) {
    const double a[3] = {p[1][0] - p[0][0], p[1][1] - p[0][1], p[1][2] - p[0][2]};
    const double b[3] = {p[2][0] - p[0][0], p[2][1] - p[0][1], p[2][2] - p[0][2]};
    const double v[3] = {-p[0][0], -p[0][1], -p[0][2]}, e[3] = {x[0] - p[0][0], x[1] - p[0][1], x[2] - p[0][2]};
    const double rounding = GXP_NEAR_ROUNDING * gxp_size(a) * gxp_size(b);
    double n[3], h, g;
    gxp_cross(n, a, b);
    h = gxp_dot(n, v);
    g = gxp_dot(n, e);
    return (h > rounding * gxp_size(v) && g > rounding * gxp_size(e)) ||
           (h < -rounding * gxp_size(v) && g < -rounding * gxp_size(e));
}

/* Tries the faces of an element that is all its cell's, but those that hide behind it. x: its moved corners less the
   point. hides: 0 where faces are bent, which may hide less than flat ones */
static void gxp_try_faces(gxp_near_walk *own, uint32_t cell, double x[4][3], int hides) {
    static const double corner[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    int k, i;
    for (k = 0; k < 4; k++) {
        const double *lambda[3];
        double p[3][3];
        for (i = 0; i < 3; i++) {
            lambda[i] = corner[gxp_outward[k][i]];
            memcpy(p[i], x[gxp_outward[k][i]], sizeof p[i]);
        }
        if (!hides || !gxp_is_beside(p, x[k])) gxp_try_triangle(own, cell, p, lambda);
    }
}

/* Tries the facets that bound a cell of a divided element. */
static gx_result gxp_try_facets(gx_body *body, gxp_near_walk *own, uint32_t cell, double x[4][3]) {
    const gxp_boundary *boundary = &body->scratch.boundary;
    const gxp_cell *c = &body->cells.data[cell];
    const int bent = gxp_is_bent(body, c);
    double rest[12], material[3];
    uint32_t i;
    int k, j;
    gx_result result;
    gxp_element_positions(body, c->element, rest);
    gxp_clear_boundary(body, 1);
    result = gxp_bound_cell(body, cell, 1);
    for (i = 0; i < boundary->triangles.count && result == GX_OK; i += 3) {
        const double *lambda[3];
        double p[3][3];
        for (k = 0; k < 3; k++) {
            const double *l = lambda[k] = boundary->lambdas + 4 * (size_t)boundary->triangles.data[i + (uint32_t)k];
            for (j = 0; j < 3; j++) p[k][j] = l[0] * x[0][j] + l[1] * x[1][j] + l[2] * x[2][j] + l[3] * x[3][j];
            if (bent) {
                gxp_weigh_material(rest, l, material);
                gxp_add_bend(body, c->copies, l, 4, material, p[k]);
            }
        }
        gxp_try_triangle(own, cell, p, lambda);
    }
    return result;
}

static gx_result gxp_visit_near(gx_body *body, gxp_walk *walk, uint32_t element) {
    gxp_near_walk *own = (gxp_near_walk *)(void *)walk;
    const int divided = (int)(gxb_complex_root(body->complex, element) & 1);
    uint32_t cell;
    gx_result result = GX_OK;
    for (cell = element; cell != GXP_NONE && result == GX_OK; cell = body->cells.data[cell].next) {
        const gxp_cell *c = &body->cells.data[cell];
        double x[4][3];
        gxp_bounds box;
        if (!c->kept || (own->admits != NULL && !own->admits(own->user, cell))) continue;
        if (divided) {
            gxp_cell_bounds(body, element, c, &box);
            if (gxp_bound_distance(walk, &box) > walk->limit) continue;
        }
        gxp_cell_corners(body, c, 1, own->point, x);
        if (divided)
            result = gxp_try_facets(body, own, cell, x);
        else
            gxp_try_faces(own, cell, x, !gxp_is_bent(body, c));
    }
    return result;
}

/* Finds the cell nearest to a point of space, among those for which admits(user, cell) is not 0 (NULL: all), of equally
   near ones the first one. The point lies in none of them (gxp_find_cells_at). */
static gx_result gxp_find_nearest(gx_body *body, const double point[3], int (*admits)(void *user, uint32_t cell),
                                  void *user, gxp_near *near) {
    gxp_near_walk own;
    gx_result result;
    own.walk.bound = gxp_bound_distance;
    own.walk.visit = gxp_visit_near;
    own.walk.limit = GXP_TREE_ALL;
    own.point = point;
    own.admits = admits;
    own.user = user;
    memset(&own.near, 0, sizeof own.near);
    own.near.cell = GXP_NONE;
    result = gxp_walk_tree(body, &own.walk);
    *near = own.near;
    return result;
}

/* >>hits: what the caller learns of points of space ---------------------------------------------------------------- */
/* In: points of space, one or many. Out: hits: cells, material points, weights, distances. Touches the view's lists,
   the tree and its working memory. */

/* Sets all of a hit but distance, material and position. weights: of the cell's copies; the view, its indices and its
   fragments are up to date. */
static void gxp_start_hit(gx_body *body, uint32_t cell, const double weights[4], gx_hit *hit) {
    const gxp_cell *c = &body->cells.data[cell];
    int n;
    memset(hit, 0, sizeof *hit);
    hit->triangle = UINT32_MAX;
    hit->fragment = gxp_cell_fragment(body, cell);
    hit->element = c->element;
    hit->cell = body->view.indices.data[cell];
    hit->slot = body->cells.slot[cell];
    hit->slot_count = body->slots.count;
    hit->epoch = body->cuts.epoch;
    for (n = 0; n < 4; n++)
        if (weights[n] > 0) {
            hit->copies[hit->copy_count] = c->copies[n];
            hit->weights[hit->copy_count++] = weights[n];
        }
}

/* The hit of a point that the cell contains */
static void gxp_hit_inside(gx_body *body, uint32_t cell, const double point[3], gx_hit *hit) {
    double weights[4], material[3];
    if (gxp_is_bent(body, &body->cells.data[cell]))
        (void)gxp_find_in_bent(body, cell, point, weights, material);
    else
        (void)gxp_pull_back(body, cell, point, weights, material);
    gxp_start_hit(body, cell, weights, hit);
    memcpy(hit->material, material, sizeof hit->material);
    memcpy(hit->position, point, sizeof hit->position);
}

/* The hit of a point outside of all cells. Its distance is above 0 even where it rounds to 0. */
static void gxp_hit_near(gx_body *body, const gxp_near *near, gx_hit *hit) {
    double rest[12];
    gxp_start_hit(body, near->cell, near->weights, hit);
    gxp_element_positions(body, hit->element, rest);
    gxp_weigh_material(rest, near->weights, hit->material);
    gxp_map_point(body, hit->material, hit->copies, hit->weights, hit->copy_count, hit->position);
    hit->distance = fmax(sqrt(near->square), ldexp(1, -1000));
}

/* The hit of a point that the cells in tree.found contain, or the nearest if there are none */
static gx_result gxp_make_hit(gx_body *body, const double point[3], gx_hit *hit) {
    gxp_near near;
    gx_result result = GX_OK;
    if (body->tree.found.count > 0)
        gxp_hit_inside(body, body->tree.found.data[0], point, hit);
    else {
        result = gxp_find_nearest(body, point, NULL, NULL, &near);
        if (result == GX_OK) gxp_hit_near(body, &near, hit);
    }
    return result;
}

static gx_result gxp_locate(gx_body *body, const double point[3], gx_hit *hit) {
    const gx_result result = gxp_find_cells_at(body, point, &body->tree.found);
    return result == GX_OK ? gxp_make_hit(body, point, hit) : result;
}

/* A number as points and displacements may have it */
static gx_result gxp_check_near(double x) {
    return gxp_is_near(x) ? GX_OK : gxp_is_finite(x) ? GX_ERROR_RANGE : GX_ERROR_NOT_FINITE;
}

static gx_result gxp_check_points(const double *points, size_t count, const char *field, int indexed,
                                  gx_failure *failure) {
    size_t i;
    for (i = 0; i < 3 * count; i++) {
        const gx_result result = gxp_check_near(points[i]);
        if (result != GX_OK) return gxp_fail(failure, result, field, indexed ? i / 3 : SIZE_MAX);
    }
    return GX_OK;
}

/* Blames a copy that is where no cell can be located: its displacement is not finite or too large. */
static gx_result gxp_check_copy(const gx_body *body, uint32_t copy, gx_failure *failure) {
    gx_result worst = GX_ERROR_RANGE;
    int k;
    for (k = 0; k < 3; k++)
        if (!gxp_is_finite(body->copies.displacement[3 * (size_t)copy + (size_t)k])) worst = GX_ERROR_NOT_FINITE;
    return gxp_fail(failure, worst, "displacement", copy);
}

/* Brings what locating reads up to date: the view, its indices, the tree. */
static gx_result gxp_prepare_locate(gx_body *body, gx_failure *failure) {
    uint32_t wild;
    gx_result result = gxp_update_view(body);
    if (result == GX_OK) result = gxp_list_indices(body);
    if (result == GX_OK) result = gxp_refit_tree(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    if (body->view.count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "body", SIZE_MAX);
    wild = gxp_wild_copy(body);
    return wild == GXP_NONE ? GX_OK : gxp_check_copy(body, wild, failure);
}

/* --- many points --- */

/* More points than that are located along a curve through space: data of the tree and of elements is in the cache for
   all points that are near. */
#define GXP_LOCATE_FEW 8

/* Points that lie close together, at most so many, share one walk to the elements near them, if these are no more than
   GXP_GROUP_ELEMENTS. */
#define GXP_GROUP_POINTS   32
#define GXP_GROUP_ELEMENTS 128

/* The points order.data[first ... end-1], and their box */
typedef struct gxp_group {
    uint32_t first, end;
    gxp_bounds box;
} gxp_group;

/* Takes further points into a group while its box is no longer than reach. */
static void gxp_grow_group(const gxp_keys *order, const double *points, double reach, gxp_group *group) {
    int k;
    gxp_empty_bounds(&group->box);
    for (group->end = group->first; group->end < order->count && group->end < group->first + GXP_GROUP_POINTS;
         group->end++) {
        const double *x = points + 3 * (size_t)GXP_SECOND(order->data[group->end]);
        gxp_bounds box = group->box, own;
        memcpy(own.low, x, sizeof own.low);
        memcpy(own.high, x, sizeof own.high);
        gxp_add_bounds(&box, &own);
        for (k = 0; k < 3; k++)
            if (box.high[k] - box.low[k] > reach && group->end > group->first) return;
        group->box = box;
    }
}

/* Lists an element that is near a group. Its error ends the walk where there are too many. */
static gx_result gxp_visit_near_group(gx_body *body, void *user, uint32_t place) {
    (void)user;
    return body->tree.near.count < GXP_GROUP_ELEMENTS ? gxp_push(body, &body->tree.near, place) : GX_ERROR_CAPACITY;
}

/* Finds the cells at a point of a group among the elements near it: tree.found. */
static gx_result gxp_find_cells_near(gx_body *body, const double point[3]) {
    const gxp_tree *tree = &body->tree;
    gxp_point_walk walk;
    gxp_bounds box;
    uint32_t i;
    gx_result result = GX_OK;
    memcpy(box.low, point, sizeof box.low);
    memcpy(box.high, point, sizeof box.high);
    walk.point = point;
    walk.cells = &body->tree.found;
    walk.cells->count = 0;
    for (i = 0; i < tree->near.count && result == GX_OK; i++)
        if (!(gxp_gap(&tree->own_boxes[tree->near.data[i]], &box) > 0))
            result = gxp_visit_at_point(body, &walk, tree->near.data[i]);
    return result;
}

static gx_result gxp_locate_group(gx_body *body, const double *points, const gxp_group *group, gx_hit *hits) {
    const gxp_keys *order = &body->tree.order;
    uint32_t i;
    int together = group->end > group->first + 1;
    gx_result result = GX_OK;
    body->tree.near.count = 0;
    if (together) result = gxp_meet_box(body, &group->box, gxp_visit_near_group, NULL);
    if (result == GX_ERROR_CAPACITY) {
        together = 0;
        result = GX_OK;
    }
    for (i = group->first; i < group->end && result == GX_OK; i++) {
        const size_t point = GXP_SECOND(order->data[i]);
        const double *x = points + 3 * point;
        result = together ? gxp_find_cells_near(body, x) : gxp_find_cells_at(body, x, &body->tree.found);
        if (result == GX_OK) result = gxp_make_hit(body, x, &hits[point]);
    }
    return result;
}

/* The edge of a cube that has the volume of the body's box at rest over the leaves of the tree */
static double gxp_leaf_size(const gx_body *body) {
    const gxp_box *all = &body->mesh.boxes[0];
    double size = 1;
    int k;
    for (k = 0; k < 3; k++) size *= cbrt(all->high[k] - all->low[k]);
    return size / cbrt((double)body->tree.cluster_count * GXP_TREE_LEAVES);
}

static gx_result gxp_locate_many(gx_body *body, const double *points, uint32_t count, gx_hit *hits) {
    const double reach = gxp_leaf_size(body);
    gxp_keys *order = &body->tree.order;
    gxp_group group;
    uint32_t i;
    gx_result result;
    order->count = 0;
    result = gxp_keys_room(body, order, 2 * (size_t)count); /* sorting takes as much again */
    for (i = 0; i < count && result == GX_OK; i++)
        result = gxp_push_key(body, order, gxp_curve_place(body, points + 3 * (size_t)i), i);
    if (result == GX_OK) result = gxp_sort_keys(body, order, 0, count);
    for (group.first = 0; group.first < count && result == GX_OK; group.first = group.end) {
        gxp_grow_group(order, points, reach, &group);
        result = gxp_locate_group(body, points, &group, hits);
    }
    return result;
}

GXFEM_API gx_result gx_body_locate(gx_body *body, const double *points, size_t count, gx_hit *hits,
                                   gx_failure *failure) {
    gx_result result;
    size_t i;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (points == NULL && count > 0) return gxp_refuse(failure, "points");
    if (hits == NULL && count > 0) return gxp_refuse(failure, "hits");
    if (count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "count", SIZE_MAX);
    result = gxp_check_points(points, count, "points", 1, failure);
    if (result == GX_OK) result = gxp_prepare_locate(body, failure);
    if (result != GX_OK) return result;
    if (count > GXP_LOCATE_FEW)
        result = gxp_locate_many(body, points, (uint32_t)count, hits);
    else
        for (i = 0; i < count && result == GX_OK; i++) result = gxp_locate(body, points + 3 * i, &hits[i]);
    return gxp_end(failure, result);
}

GXFEM_API gx_result gx_body_locate_all(gx_body *body, const double point[3], gx_hit *hits, size_t capacity,
                                       size_t *count, gx_failure *failure) {
    gx_result result;
    size_t i;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (point == NULL) return gxp_refuse(failure, "point");
    if (hits == NULL && capacity > 0) return gxp_refuse(failure, "hits");
    if (count == NULL) return gxp_refuse(failure, "count");
    result = gxp_check_points(point, 1, "point", 0, failure);
    if (result == GX_OK) result = gxp_prepare_locate(body, failure);
    if (result != GX_OK) return result;
    result = gxp_find_cells_at(body, point, &body->tree.found);
    if (gxp_end(failure, result) != GX_OK) return result;
    *count = body->tree.found.count;
    if (capacity < *count) return gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    for (i = 0; i < *count; i++) gxp_hit_inside(body, body->tree.found.data[i], point, &hits[i]);
    return GX_OK;
}

GXFEM_API gx_result gx_body_place(const gx_body *body, uint32_t slot, const double material[3], double position[3],
                                  gx_failure *failure) {
    uint32_t cell;
    gx_result result;
    int n, k;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (material == NULL) return gxp_refuse(failure, "material");
    if (position == NULL) return gxp_refuse(failure, "position");
    if (slot >= body->slots.count) return gxp_fail(failure, GX_ERROR_INDEX, "slot", SIZE_MAX);
    cell = gxp_kept_cell(body, slot);
    if (cell == GXP_NONE) return gxp_fail(failure, GX_ERROR_EMPTY, "slot", SIZE_MAX);
    result = gxp_check_points(material, 1, "material", 0, failure);
    for (n = 0; n < 4 && result == GX_OK; n++)
        for (k = 0; k < 3 && result == GX_OK; k++)
            if (!gxp_is_near(body->copies.displacement[3 * (size_t)body->cells.data[cell].copies[n] + (size_t)k]))
                result = gxp_check_copy(body, body->cells.data[cell].copies[n], failure);
    if (result != GX_OK) return result;
    gxp_image(body, cell, material, position);
    return gxp_end(failure, GX_OK);
}

/* >>rays: picking -------------------------------------------------------------------------------------------------- */
/* In: a ray. Out: where it first meets the deformed skin. The tree leads to the elements that the ray may meet; the
   triangles that these show are tested exactly. Touches the tree and the view's lists. */

/* The ray's coordinates: two across it, sheared along the largest component of its direction, and the distance along it
   in lengths of direction */
typedef struct gxp_ray_walk {
    gxp_walk walk; /* limit: the distance of the triangle found */
    const double *origin, *direction;
    double slope[2];  /* of the two coordinates across, along the axis */
    double margin[3]; /* of the ray's coordinates of a box: above all rounding of those of points in it */
    int axis;
    uint32_t found; /* triangle, UINT32_MAX: none */
    double share[3];
} gxp_ray_walk;

static void gxp_shear(const gxp_ray_walk *ray, const double x[3], double across[3]) {
    const double *o = ray->origin, *d = ray->direction;
    const int axis = ray->axis, i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double along = (x[axis] - o[axis]) / d[axis], p = x[i] - o[i], q = x[j] - o[j];
    across[0] = p - along * d[i];
    across[1] = q - along * d[j];
    across[2] = along;
}

/* Share of coordinates' sizes (2^-44), far above the rounding of the ray's coordinates: a few units of 2^-52 */
#define GXP_RAY_MARGIN 5.6843418860808015e-14

/* A quotient along the ray that falls below all doubles, or is flushed to 0, is wrong by 2^-1022 at most. */
static void gxp_start_ray(const gx_body *body, const double origin[3], const double direction[3], gxp_ray_walk *ray) {
    const gxp_bounds *all = &body->tree.boxes[0];
    double size = 0;
    int axis = 0, k;
    for (k = 1; k < 3; k++)
        if (fabs(direction[k]) > fabs(direction[axis])) axis = k;
    for (k = 0; k < 3; k++) size = fmax(size, fmax(fmax(fabs(all->low[k]), fabs(all->high[k])), fabs(origin[k])));
    ray->origin = origin;
    ray->direction = direction;
    ray->axis = axis;
    for (k = 0; k < 2; k++) {
        ray->slope[k] = direction[(axis + 1 + k) % 3] / direction[axis];
        ray->margin[k] = GXP_RAY_MARGIN * size + fabs(direction[axis]) * ldexp(1, -1021);
    }
    ray->margin[2] = GXP_RAY_MARGIN * (size / fabs(direction[axis])) + ldexp(1, -1021);
    ray->found = UINT32_MAX;
}

/* Where the ray may first meet the box, less the margin. A box is left out only where that is certain, so that what is
   not finite does no harm. */
static double gxp_bound_ray(const gxp_walk *walk, const gxp_bounds *box) {
    const gxp_ray_walk *ray = (const gxp_ray_walk *)(const void *)walk;
    const int axis = ray->axis;
    const double low = box->low[axis] - ray->origin[axis], high = box->high[axis] - ray->origin[axis];
    const double first = low / ray->direction[axis], last = high / ray->direction[axis];
    const double near = (first < last ? first : last) - ray->margin[2],
                 far = (first < last ? last : first) + ray->margin[2];
    int k, beyond = far < 0;
    for (k = 0; k < 2; k++) {
        const int i = (axis + 1 + k) % 3;
        const double p = low * ray->slope[k], q = high * ray->slope[k];
        beyond |= box->low[i] - ray->origin[i] - (p > q ? p : q) > ray->margin[k];
        beyond |= box->high[i] - ray->origin[i] - (p > q ? q : p) < -ray->margin[k];
    }
    return beyond ? GXP_TREE_BEYOND : near > 0 ? near : 0;
}

/* Does the ray pass through the triangle? p: its corners in the ray's coordinates. share: the weights of its corners at
   the point; distance: of the point. The signs are exact, so that no ray slips through between triangles that share
   corners. */
static int gxp_meet_triangle(double p[3][3], double share[3], double *distance) {
    static const double ray[2] = {0, 0};
    double sum = 0;
    int k, positive = 0, negative = 0;
    for (k = 0; k < 2; k++)
        if (!(fmin(p[0][k], fmin(p[1][k], p[2][k])) <= 0 && fmax(p[0][k], fmax(p[1][k], p[2][k])) >= 0)) return 0;
    for (k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        const int side = gxb_orient2d(ray, a, b);
        positive |= side > 0;
        negative |= side < 0;
        share[k] = fabs(a[0] * b[1] - a[1] * b[0]);
        sum += share[k];
    }
    if (positive == negative || !(sum > 0)) return 0; /* the ray passes beside the triangle or lies in its plane */
    *distance = 0;
    for (k = 0; k < 3; k++) {
        share[k] /= sum;
        *distance += share[k] * p[k][2];
    }
    return *distance >= 0;
}

/* Tests the triangles that an element shows. Of equally near ones the first of the skin counts. */
static gx_result gxp_visit_on_ray(gx_body *body, gxp_walk *walk, uint32_t element) {
    gxp_ray_walk *ray = (gxp_ray_walk *)(void *)walk;
    const gxp_skin *s = &body->skin;
    uint32_t t;
    int k;
    for (t = s->first.data[element]; t != GXP_NONE; t = s->links[t].next) {
        double p[3][3], x[3], share[3], distance;
        for (k = 0; k < 3; k++) {
            const size_t v = s->triangles[3 * (size_t)t + (size_t)k];
            gxp_map_point(body, s->rest + 3 * v, s->copies + 4 * v, s->weights + 4 * v, 4, x);
            gxp_shear(ray, x, p[k]);
        }
        if (!gxp_meet_triangle(p, share, &distance) || distance > walk->limit) continue;
        if (ray->found != UINT32_MAX && !(distance < walk->limit) && t > ray->found) continue;
        ray->found = t;
        walk->limit = distance;
        memcpy(ray->share, share, sizeof share);
    }
    return GX_OK;
}

/* A point of up to GXS_POINT_OWN copies holds them itself, others refer to the arrays. */
static gxs_point gxp_make_point(const uint32_t *copies, const double *weights, uint32_t count, const double rest[3],
                                uint64_t epoch) {
    gxs_point point;
    memset(&point, 0, sizeof point);
    point.count = count;
    if (count <= GXS_POINT_OWN) {
        memcpy(point.copy, copies, count * sizeof *copies);
        memcpy(point.weight, weights, count * sizeof *weights);
    } else {
        point.copies = copies;
        point.weights = weights;
    }
    memcpy(point.position, rest, sizeof point.position);
    point.epoch = epoch;
    return point;
}

GXFEM_API gxs_point gx_skin_point(const gx_skin *skin, uint32_t vertex) {
    const size_t first = (size_t)vertex * skin->vertex_width;
    return gxp_make_point(skin->vertex_copies + first, skin->vertex_weights + first, skin->vertex_width,
                          skin->vertex_rest + 3 * (size_t)vertex, skin->epoch);
}

GXFEM_API gxs_point gx_hit_point(const gx_hit *hit) {
    return gxp_make_point(hit->copies, hit->weights, hit->copy_count, hit->material, hit->epoch);
}

/* The copies of the triangle's corners with their weights, at most four in all: a triangle lies in one element. */
static void gxp_fill_hit(const gx_body *body, uint32_t triangle, const double share[3], gx_hit *hit) {
    const gxp_skin *s = &body->skin;
    uint32_t i, k, n, count = 0;
    int j;
    hit->triangle = triangle;
    hit->epoch = body->cuts.epoch;
    hit->fragment = s->fragment[triangle];
    hit->element = s->element[triangle];
    hit->surface = s->surface[triangle];
    hit->slot = body->cells.slot[s->cell[triangle]];
    hit->slot_count = body->slots.count;
    hit->cell = body->view.indices.data[s->cell[triangle]];
    for (i = 0; i < 3; i++) {
        const size_t v = s->triangles[3 * (size_t)triangle + i];
        for (j = 0; j < 3; j++) hit->material[j] += share[i] * s->rest[3 * v + (size_t)j];
        for (k = 0; k < 4 && s->weights[4 * v + k] > 0; k++) {
            const double weight = share[i] * s->weights[4 * v + k];
            if (!(weight > 0)) continue; /* the ray meets an edge or a corner */
            for (n = 0; n < count && hit->copies[n] != s->copies[4 * v + k]; n++) {}
            if (n == count) hit->copies[count++] = s->copies[4 * v + k];
            hit->weights[n] += weight;
        }
    }
    hit->copy_count = count;
    gxp_map_point(body, hit->material, hit->copies, hit->weights, count, hit->position);
}

static gx_result gxp_check_ray(const gx_body *body, const double origin[3], const double direction[3],
                               gx_failure *failure) {
    if (body == NULL) return gxp_refuse(failure, "body");
    if (origin == NULL) return gxp_refuse(failure, "origin");
    if (direction == NULL) return gxp_refuse(failure, "direction");
    if (gxp_check_vector(origin, "origin", failure) != GX_OK ||
        gxp_check_vector(direction, "direction", failure) != GX_OK)
        return GX_ERROR_NOT_FINITE;
    return gxp_dot(direction, direction) > 0 ? GX_OK : gxp_refuse(failure, "direction");
}

GXFEM_API gx_result gx_body_pick(gx_body *body, const double origin[3], const double direction[3], gx_hit *hit,
                                 gx_failure *failure) {
    gxp_ray_walk ray;
    gx_result result = gxp_check_ray(body, origin, direction, failure);
    if (result != GX_OK) return result;
    if (hit == NULL) return gxp_refuse(failure, "hit");
    if (!gxp_has_skin(body)) return gxp_fail(failure, GX_ERROR_SEQUENCE, "gx_body_skin", SIZE_MAX);
    result = gxp_update_view(body);
    if (result == GX_OK) result = gxp_list_indices(body);
    if (result == GX_OK) result = gxp_refit_tree(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    ray.walk.bound = gxp_bound_ray;
    ray.walk.visit = gxp_visit_on_ray;
    ray.walk.limit = GXP_TREE_ALL;
    gxp_start_ray(body, origin, direction, &ray);
    (void)gxp_walk_tree(body, &ray.walk);
    memset(hit, 0, sizeof *hit);
    hit->triangle = ray.found;
    if (ray.found == UINT32_MAX) return GX_OK;
    hit->distance = ray.walk.limit;
    gxp_fill_hit(body, ray.found, ray.share, hit);
    return GX_OK;
}

/* >>touch: the surface of contact ---------------------------------------------------------------------------------- */
/* In: the cells, the state of the surface before a cut. Out: samples and facets, with the state that the material had.
   Touches what a step with contact works with; the skin that the caller sees stays as it is. */

/* The surface is made from nothing after each cut, so that it depends on the body alone, not on its history: a skin of
   its own, of which samples and facets are copied. */

/* Where the surface bends by more, rad, each side has samples with a normal of its own. */
#define GXP_TOUCH_CREASE 0.7
#define GXP_TOUCH_LEAF   4u
/* Samples: a cosine, from which on a surface or its rim counts as even; in sizes of an element, how far a vertex may be
   from the sample that takes its share of an even surface, and how large the shares of that one may become */
#define GXP_TOUCH_EVEN  0.98
#define GXP_TOUCH_APART 0.5
#define GXP_TOUCH_SHARE 0.35
enum { GXP_TOUCH_INSIDE, GXP_TOUCH_RIM, GXP_TOUCH_CORNER }; /* of a vertex: where it is on an even part of a surface */

/* Releases the arrays of body.skin. */
static void gxp_release_skin(gx_body *body) {
    const size_t first = offsetof(gx_body, skin), end = first + sizeof body->skin;
    const gxp_table *vertices = &gxp_tables[GXP_SKIN_VERTICES], *triangles = &gxp_tables[GXP_SKIN_TRIANGLES];
    size_t i;
    gxp_release_columns(body, vertices->columns, vertices->column_count);
    gxp_release_columns(body, triangles->columns, triangles->column_count);
    for (i = 0; i < sizeof gxp_lists / sizeof *gxp_lists; i++)
        if (gxp_lists[i].array >= first && gxp_lists[i].array < end) gxp_release_columns(body, &gxp_lists[i], 1);
}

/* To which of six sides does a triangle of body.skin face at rest? */
static uint32_t gxp_facet_side(const gxp_skin *s, uint32_t t) {
    double n[3];
    uint32_t k, most = 0;
    gxp_triangle_normal(s->rest, s->triangles + 3 * (size_t)t, n);
    for (k = 1; k < 3; k++)
        if (fabs(n[k]) > fabs(n[most])) most = k;
    return 2 * most + (n[most] < 0);
}

/* Lists the triangles of body.skin by fragment, by the side to which they face, then along a curve through space at
   rest: touch.ranked[second of touch.order[i]] is the i-th. */
static gx_result gxp_order_facets(gx_body *body) {
    const gxp_skin *s = &body->skin;
    gxp_keys *order = &body->touch.order;
    gxp_words *ranked = &body->touch.ranked;
    gx_result result = gxp_start_words(body, ranked, s->triangle_count);
    uint32_t i;
    order->count = 0;
    if (result == GX_OK) result = gxp_keys_room(body, order, 2 * (size_t)s->triangle_count);
    if (result != GX_OK) return result;
    for (i = 0; i < s->triangle_count; i++)
        order->data[order->count++] =
            (uint64_t)gxp_curve_place(body, s->rest + 3 * (size_t)s->triangles[3 * (size_t)i]) << 32 | i;
    result = gxp_sort_keys(body, order, 0, order->count);
    for (i = 0; i < order->count && result == GX_OK; i++) {
        const uint32_t t = GXP_SECOND(order->data[i]);
        ranked->data[ranked->count++] = t;
        order->data[i] = (uint64_t)(8 * s->fragment[t] + gxp_facet_side(s, t)) << 32 | i;
    }
    return result == GX_OK ? gxp_sort_keys(body, order, 0, order->count) : result;
}

static void gxp_copy_sample(const gxp_skin *s, uint32_t i, gxp_touch_vertex *v) {
    double n[3];
    int k;
    memset(v, 0, sizeof *v);
    memcpy(v->copies, s->copies + 4 * (size_t)i, sizeof v->copies);
    memcpy(v->weights, s->weights + 4 * (size_t)i, sizeof v->weights);
    memcpy(v->rest, s->rest + 3 * (size_t)i, sizeof v->rest);
    for (k = 0; k < 3; k++) n[k] = (double)s->normal[3 * (size_t)i + (size_t)k];
    (void)gxp_unit(n, v->normal);
    v->element = GXP_NONE;
    v->stands = i;
}

/* Twice the area of a facet at rest, along its normal */
static void gxp_facet_normal(const gxp_touch_surface *s, const gxp_touch_facet *f, double n[3]) {
    static const uint32_t corner[3] = {0, 1, 2};
    double x[9];
    int i;
    for (i = 0; i < 3; i++) memcpy(x + 3 * i, s->vertices[f->vertex[i]].rest, 3 * sizeof *x);
    gxp_triangle_normal(x, corner, n);
}

/* A facet, which gives its corners a third of its area */
static void gxp_copy_facet(const gx_body *body, uint32_t t, gxp_touch_surface *to, gxp_touch_facet *facet) {
    const gxp_skin *s = &body->skin;
    double n[3];
    int k;
    memcpy(facet->vertex, s->triangles + 3 * (size_t)t, sizeof facet->vertex);
    facet->element = s->element[t];
    facet->fragment = s->fragment[t];
    gxp_triangle_normal(s->rest, facet->vertex, n);
    for (k = 0; k < 3; k++) {
        gxp_touch_vertex *v = &to->vertices[facet->vertex[k]];
        v->area = v->given += gxp_size(n) / 6;
        if (v->element != GXP_NONE) continue;
        v->element = facet->element;
        v->fragment = facet->fragment;
        v->size = cbrt(6 * gxp_element_volume(body, v->element));
        to->largest = fmax(to->largest, v->size);
        v->young = body->mesh.materials[s->material[t]].elastic.young;
    }
}

/* Copies what contact needs of body.skin. */
static gx_result gxp_copy_samples(gx_body *body, gxp_touch_surface *to) {
    const gx_allocator *a = &body->config.allocator;
    const gxp_skin *s = &body->skin;
    uint32_t i;
    gx_result result = gxp_order_facets(body);
    if (result == GX_OK)
        result = gxp_reserve(a, &to->vertices, sizeof *to->vertices, 0, &to->vertex_capacity, s->vertex_count);
    if (result == GX_OK)
        result = gxp_reserve(a, &to->facets, sizeof *to->facets, 0, &to->facet_capacity, s->triangle_count);
    if (result == GX_OK) result = gxp_start_words(body, &to->guesses, s->vertex_count);
    if (result != GX_OK) return result;
    to->vertex_count = s->vertex_count;
    to->facet_count = s->triangle_count;
    to->largest = 0;
    for (i = 0; i < to->vertex_count; i++) {
        gxp_copy_sample(s, i, &to->vertices[i]);
        to->guesses.data[to->guesses.count++] = GXP_NONE;
    }
    for (i = 0; i < to->facet_count; i++)
        gxp_copy_facet(body, body->touch.ranked.data[GXP_SECOND(body->touch.order.data[i])], to, &to->facets[i]);
    return GX_OK;
}

/* Lists the edges of the facets both ways, ascending; those of two facets are there twice. */
static gx_result gxp_list_edges(gx_body *body, const gxp_touch_surface *s) {
    gxp_keys *edges = &body->touch.edges;
    uint32_t i, n;
    gx_result result;
    edges->count = 0;
    result = gxp_keys_room(body, edges, 12 * (size_t)s->facet_count);
    for (i = 0; i < s->facet_count && result == GX_OK; i++)
        for (n = 0; n < 3; n++) {
            const uint64_t a = s->facets[i].vertex[n], b = s->facets[i].vertex[(n + 1) % 3];
            edges->data[edges->count++] = a << 32 | b;
            edges->data[edges->count++] = b << 32 | a;
        }
    return result == GX_OK ? gxp_sort_keys(body, edges, 0, edges->count) : result;
}

/* Is the i-th of the edges from `first` to end - 1, which lead away from one vertex, one of the rim? */
static int gxp_is_rim(const gxp_keys *edges, uint32_t first, uint32_t end, uint32_t i) {
    return (i == first || edges->data[i - 1] != edges->data[i]) &&
           (i + 1 == end || edges->data[i + 1] != edges->data[i]);
}

/* The role of a vertex that the edges from `first` to end - 1 lead away from: on a rim it is a corner, unless the rim
   is straight there. */
static uint32_t gxp_role_of(const gxp_touch_surface *s, const gxp_keys *edges, uint32_t first, uint32_t end) {
    const double *x = s->vertices[GXP_FIRST(edges->data[first])].rest;
    double way[2][3] = {{0, 0, 0}, {0, 0, 0}};
    uint32_t i, rims = 0;
    int k;
    for (i = first; i < end; i++) {
        double d[3];
        if (!gxp_is_rim(edges, first, end, i)) continue;
        if (rims == 2) return GXP_TOUCH_CORNER;
        for (k = 0; k < 3; k++) d[k] = s->vertices[GXP_SECOND(edges->data[i])].rest[k] - x[k];
        (void)gxp_unit(d, way[rims++]);
    }
    return rims == 0 ? GXP_TOUCH_INSIDE : gxp_dot(way[0], way[1]) < -GXP_TOUCH_EVEN ? GXP_TOUCH_RIM : GXP_TOUCH_CORNER;
}

/* Gives all vertices their roles. Where the surface bends, they are corners. */
static gx_result gxp_give_roles(gx_body *body, const gxp_touch_surface *s) {
    const gxp_keys *edges = &body->touch.edges;
    gxp_words *roles = &body->touch.roles;
    gx_result result = gxp_start_words(body, roles, s->vertex_count);
    uint32_t i, n, end;
    if (result != GX_OK) return result;
    for (; roles->count < s->vertex_count;) roles->data[roles->count++] = GXP_TOUCH_CORNER;
    for (i = 0; i < edges->count; i = end) {
        for (end = i; end < edges->count && GXP_FIRST(edges->data[end]) == GXP_FIRST(edges->data[i]);) end++;
        roles->data[GXP_FIRST(edges->data[i])] = gxp_role_of(s, edges, i, end);
    }
    for (i = 0; i < s->facet_count; i++) {
        double normal[3], unit[3];
        gxp_facet_normal(s, &s->facets[i], normal);
        if (!gxp_unit(normal, unit)) continue;
        for (n = 0; n < 3; n++)
            if (gxp_dot(unit, s->vertices[s->facets[i].vertex[n]].normal) < GXP_TOUCH_EVEN)
                roles->data[s->facets[i].vertex[n]] = GXP_TOUCH_CORNER;
    }
    return GX_OK;
}

/* May the sample w stand for a vertex v, to which a facet's edge joins it? rim: the edge is of the rim */
static int gxp_stands_for(const gxp_touch_vertex *w, const gxp_touch_vertex *v, uint32_t role, int rim) {
    return w->area > 0 && (rim || role == GXP_TOUCH_INSIDE) &&
           gxp_square_distance(v->rest, w->rest) < GXP_TOUCH_APART * v->size * GXP_TOUCH_APART * v->size &&
           w->area + v->area < GXP_TOUCH_SHARE * v->size * v->size;
}

/* Chooses the samples: a cut divides elements, so that vertices are closer to each other than copies are. A vertex that
   is close to a sample on the same even surface gives it its area, and is none. Corners are samples anyhow. */
static gx_result gxp_choose_samples(gx_body *body, gxp_touch_surface *s) {
    const gxp_keys *edges = &body->touch.edges;
    gx_result result = gxp_list_edges(body, s);
    uint32_t i, j, end;
    if (result == GX_OK) result = gxp_give_roles(body, s);
    for (i = 0; i < edges->count && result == GX_OK; i = end) {
        const uint32_t vertex = GXP_FIRST(edges->data[i]);
        gxp_touch_vertex *v = &s->vertices[vertex];
        double best = GXP_TREE_ALL;
        for (end = i; end < edges->count && GXP_FIRST(edges->data[end]) == vertex;) end++;
        for (j = i; j < end && body->touch.roles.data[vertex] != GXP_TOUCH_CORNER; j++) {
            const uint32_t other = GXP_SECOND(edges->data[j]);
            gxp_touch_vertex *w = &s->vertices[other];
            const double square = gxp_square_distance(v->rest, w->rest);
            if (other > vertex && body->touch.roles.data[other] != GXP_TOUCH_CORNER) continue; /* it may be none yet */
            if (!gxp_stands_for(w, v, body->touch.roles.data[vertex], gxp_is_rim(edges, i, end, j)) || square >= best)
                continue;
            best = square;
            v->stands = other;
        }
        if (v->stands == vertex) continue;
        s->vertices[v->stands].area += v->area;
        v->area = 0;
    }
    return result;
}

/* Lists the samples by the first facet that each is a corner of. */
static gx_result gxp_list_chosen(gx_body *body, gxp_touch_surface *s) {
    gxp_words *listed = &body->touch.roles; /* of each vertex: 1 if it is in the list */
    gx_result result = gxp_start_words(body, &s->samples, s->vertex_count);
    uint32_t i, n;
    if (result == GX_OK) result = gxp_start_words(body, listed, s->vertex_count);
    for (i = 0; i < s->vertex_count && result == GX_OK; i++) listed->data[listed->count++] = !(s->vertices[i].area > 0);
    for (i = 0; i < s->facet_count && result == GX_OK; i++)
        for (n = 0; n < 3; n++) {
            const uint32_t vertex = s->facets[i].vertex[n];
            if (!listed->data[vertex]) s->samples.data[s->samples.count++] = vertex;
            listed->data[vertex] = 1;
        }
    return result;
}

/* Makes a surface anew, without state. */
static gx_result gxp_make_surface(gx_body *body, gxp_touch_surface *to) {
    const gxp_skin own = body->skin;
    gx_skin_desc desc;
    gx_result result;
    memset(&body->skin, 0, sizeof body->skin);
    desc.crease_angle = GXP_TOUCH_CREASE;
    desc.smooth_cuts = 1;
    result = gxp_restart_skin(body, &desc);
    if (result == GX_OK) result = gxp_remake_elements(body);
    if (result == GX_OK) result = gxp_mark_fragments(body);
    if (result == GX_OK) result = gxp_copy_samples(body, to);
    if (result == GX_OK) result = gxp_choose_samples(body, to);
    if (result == GX_OK) result = gxp_list_chosen(body, to);
    gxp_release_skin(body);
    body->skin = own;
    return result;
}

/* The first state of a sample, or of one behind it */
static uint32_t gxp_first_state(const gxp_touch_surface *s, uint32_t sample) {
    uint32_t low = 0, high = s->state_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (s->states[middle].sample < sample)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The vertex of a surface at the same place with the most similar normal; GXP_NONE: there is none. order: its vertices,
   by hashes of their places */
static uint32_t gxp_same_sample(const gxp_touch_surface *s, const gxp_keys *order, const gxp_touch_vertex *v) {
    const uint32_t hash = (uint32_t)gxp_hash_doubles(0, v->rest, 3);
    uint32_t first = gxp_first_key(order, (uint64_t)hash << 32), found = GXP_NONE;
    double best = 0.5; /* sides of a sheet have opposite normals */
    for (; first < order->count && GXP_FIRST(order->data[first]) == hash; first++) {
        const gxp_touch_vertex *w = &s->vertices[GXP_SECOND(order->data[first])];
        const double cosine = gxp_dot(v->normal, w->normal);
        if (memcmp(v->rest, w->rest, sizeof v->rest) != 0 || !(cosine > best)) continue;
        best = cosine;
        found = GXP_SECOND(order->data[first]);
    }
    return found;
}

/* The facet of a surface that a material point is on, facing the same way, and where on it; GXP_NONE: there is none.
   order: facets by element */
static uint32_t gxp_facet_at(const gxp_touch_surface *s, const gxp_keys *order, const double rest[3],
                             const double normal[3], double size, double share[3]) {
    double best = 1e-12 * size * size;
    uint32_t i, found = GXP_NONE;
    for (i = 0; i < order->count; i++) {
        const gxp_touch_facet *f = &s->facets[GXP_SECOND(order->data[i])];
        double p[3][3], own[3] = {0, 0, 0}, square;
        int n, k;
        if (gxp_dot(normal, s->vertices[f->vertex[0]].normal) < 0.5) continue;
        for (n = 0; n < 3; n++)
            for (k = 0; k < 3; k++) p[n][k] = s->vertices[f->vertex[n]].rest[k] - rest[k];
        square = gxp_near_triangle(p, best, own);
        if (!(square < best)) continue;
        best = square;
        found = GXP_SECOND(order->data[i]);
        memcpy(share, own, sizeof own);
    }
    return found;
}

/* Room for another state; it is the last one. */
static gx_result gxp_push_state(gx_body *body, gxp_touch_surface *to, const gxp_touch_state *state, uint32_t sample) {
    const gx_result result =
        gxp_reserve(&body->config.allocator, &to->states, sizeof *to->states, to->state_count, &to->state_capacity, 1);
    if (result != GX_OK) return result;
    to->states[to->state_count] = *state;
    to->states[to->state_count++].sample = sample;
    return GX_OK;
}

/* Adds a share of the states of a sample to those of the last one of another surface: of its states on pieces, or of
   those on colliders. */
static gx_result gxp_add_states(gx_body *body, const gxp_touch_surface *from, uint32_t sample, int colliders,
                                double share, gxp_touch_surface *to, uint32_t last) {
    uint32_t i = gxp_first_state(from, sample), at;
    int k;
    for (; i < from->state_count && from->states[i].sample == sample && share > 0; i++) {
        const gxp_touch_state *state = &from->states[i];
        if ((state->other != GXP_NONE) != colliders) continue;
        for (at = to->state_count;
             at > 0 && to->states[at - 1].sample == last && to->states[at - 1].other != state->other;)
            at--;
        if (at == 0 || to->states[at - 1].sample != last) {
            gxp_touch_state none;
            gx_result result;
            memset(&none, 0, sizeof none);
            none.other = state->other;
            memcpy(none.rest, to->vertices[last].rest, sizeof none.rest);
            result = gxp_push_state(body, to, &none, last);
            if (result != GX_OK) return result;
            at = to->state_count;
        }
        to->states[at - 1].pressed += share * state->pressed;
        for (k = 0; k < 3; k++) to->states[at - 1].slip[k] += share * state->slip[k];
    }
    return GX_OK;
}

/* The facets of an element: a part of `order`, which has facets, sorted by elements. Nothing of it is owned. */
static gxp_keys gxp_facets_of(const gxp_keys *order, uint32_t element) {
    gxp_keys part;
    const uint32_t first = gxp_first_key(order, (uint64_t)element << 32);
    uint32_t end;
    for (end = first; end < order->count && GXP_FIRST(order->data[end]) == element;) end++;
    part.data = order->data + first;
    part.count = part.capacity = end - first;
    return part;
}

/* Adds a share of what a surface presses with, where a vertex of another one is, to the last sample of that other one:
   on pieces, or on colliders. Between vertices it is a mean of the facet there. places: vertices of `from` by hashes of
   their places; elements: its facets by element */
static gx_result gxp_carry_vertex(gx_body *body, const gxp_touch_surface *from, const gxp_keys *places,
                                  const gxp_keys *elements, const gxp_touch_vertex *v, int colliders, double share,
                                  gxp_touch_surface *to, uint32_t last) {
    const uint32_t same = gxp_same_sample(from, places, v);
    gx_result result = GX_OK;
    double shares[3] = {0, 0, 0};
    gxp_keys facets;
    uint32_t facet;
    int n;
    if (same != GXP_NONE)
        return gxp_add_states(body, from, colliders ? same : from->vertices[same].stands, colliders, share, to, last);
    facets = gxp_facets_of(elements, v->element);
    facet = gxp_facet_at(from, &facets, v->rest, v->normal, v->size, shares);
    for (n = 0; n < 3 && facet != GXP_NONE && result == GX_OK; n++) {
        const uint32_t corner = from->facets[facet].vertex[n];
        result = gxp_add_states(body, from, colliders ? corner : from->vertices[corner].stands, colliders,
                                share * shares[n], to, last);
    }
    return result;
}

/* The states of vertices go from one surface to another. Samples get the mean over the vertices for which they stand,
   so that forces stay; those that stand for the same as before keep theirs, bit for bit. */
static gx_result gxp_carry_vertices(gx_body *body, const gxp_touch_surface *from, const gxp_keys *places,
                                    const gxp_keys *elements, gxp_touch_surface *to) {
    gxp_keys *members = &body->touch.members;
    uint32_t i, next = 0;
    gx_result result;
    members->count = 0;
    result = gxp_keys_room(body, members, 2 * (size_t)to->vertex_count);
    for (i = 0; i < to->vertex_count && result == GX_OK; i++)
        members->data[members->count++] = (uint64_t)to->vertices[i].stands << 32 | i;
    if (result == GX_OK) result = gxp_sort_keys(body, members, 0, members->count);
    for (i = 0; i < to->vertex_count && result == GX_OK; i++) {
        for (; next < members->count && GXP_FIRST(members->data[next]) == i && result == GX_OK; next++) {
            const gxp_touch_vertex *v = &to->vertices[GXP_SECOND(members->data[next])];
            result = gxp_carry_vertex(body, from, places, elements, v, 0, v->given / to->vertices[i].area, to, i);
        }
        if (result == GX_OK) result = gxp_carry_vertex(body, from, places, elements, &to->vertices[i], 1, 1, to, i);
    }
    return result;
}

/* Facets get the states of those on which they lie: all of them, since a sample takes the nearest. */
static gx_result gxp_carry_facets(gx_body *body, const gxp_touch_surface *from, const gxp_keys *elements,
                                  gxp_touch_surface *to) {
    uint32_t i, n;
    gx_result result = GX_OK;
    if (gxp_first_state(from, from->vertex_count) == from->state_count) return result;
    for (i = 0; i < to->facet_count && result == GX_OK; i++) {
        const gxp_touch_facet *f = &to->facets[i];
        const gxp_keys facets = gxp_facets_of(elements, f->element);
        const gxp_touch_vertex *v = &to->vertices[f->vertex[0]];
        double center[3], share[3];
        uint32_t facet;
        int k;
        for (k = 0; k < 3; k++)
            center[k] = (v->rest[k] + to->vertices[f->vertex[1]].rest[k] + to->vertices[f->vertex[2]].rest[k]) / 3;
        facet = gxp_facet_at(from, &facets, center, v->normal, v->size, share);
        if (facet == GXP_NONE) continue;
        for (n = gxp_first_state(from, from->vertex_count + facet);
             n < from->state_count && from->states[n].sample == from->vertex_count + facet && result == GX_OK; n++)
            result = gxp_push_state(body, to, &from->states[n], to->vertex_count + i);
    }
    return result;
}

/* The state of the material goes from one surface to another. */
static gx_result gxp_carry_states(gx_body *body, const gxp_touch_surface *from, gxp_touch_surface *to) {
    gxp_keys *places = &body->touch.order, *elements = &body->touch.placed;
    gx_result result = GX_OK;
    uint32_t i;
    to->state_count = places->count = elements->count = 0;
    if (from->state_count == 0) return result;
    result = gxp_keys_room(body, places, 2 * (size_t)from->vertex_count);
    if (result == GX_OK) result = gxp_keys_room(body, elements, 2 * (size_t)from->facet_count);
    if (result != GX_OK) return result;
    for (i = 0; i < from->vertex_count; i++)
        places->data[places->count++] = gxp_hash_doubles(0, from->vertices[i].rest, 3) << 32 | i;
    for (i = 0; i < from->facet_count; i++)
        elements->data[elements->count++] = (uint64_t)from->facets[i].element << 32 | i;
    result = gxp_sort_keys(body, places, 0, places->count);
    if (result == GX_OK) result = gxp_sort_keys(body, elements, 0, elements->count);
    if (result == GX_OK) result = gxp_carry_vertices(body, from, places, elements, to);
    return result == GX_OK ? gxp_carry_facets(body, from, elements, to) : result;
}

/* The surface of a step: the one that is there, or another, made anew after a cut */
static gx_result gxp_step_surface(gx_body *body, gxp_touch_surface **surface) {
    gxp_touch *t = &body->touch;
    gxp_touch_surface *own = &t->surfaces[t->current], *other = &t->surfaces[1 - t->current];
    gx_result result;
    *surface = own;
    if (t->made && t->hash == body->cuts.hash) return GX_OK;
    *surface = other;
    other->state_count = 0;
    result = gxp_make_surface(body, other);
    return result == GX_OK && t->made ? gxp_carry_states(body, own, other) : result;
}

/* Makes the surface of the present cuts hold the state, as the next step would: for saving. */
static gx_result gxp_refresh_contact(gx_body *body) {
    gxp_touch *t = &body->touch;
    gxp_touch_surface *surface;
    gx_result result;
    if (!t->on || !t->made || t->hash == body->cuts.hash) return GX_OK;
    result = gxp_step_surface(body, &surface);
    if (result != GX_OK) return result;
    t->current = 1 - t->current;
    t->hash = body->cuts.hash;
    t->kept = 0;
    return GX_OK;
}

/* >>colliders: where pieces meet rigid bodies ---------------------------------------------------------------------- */
/* In: colliders, the surface of contact and how it moves. Out: the tangent planes of colliders that samples meet within
   a step. Touches lists of a step. */

/* Steps by the distance to a collider on the way of a sample; a way that needs more passes it closely */
#define GXP_TOUCH_ADVANCES 16
/* Samples of facets on which the distance bends: so many to the length of what a collider has, at most so many parts of
   an edge. A cosine: normals of a collider that bend less are as good as one */
#define GXP_TOUCH_FINE  4
#define GXP_TOUCH_PARTS 24u
#define GXP_TOUCH_FLAT  0.995
/* In sizes of an element: gaps that have a pair if the step may make them smaller */
#define GXP_TOUCH_NEAR 0.02

/* Signed distance from a ball around the origin */
static double gxp_ball_distance(const double p[3], double radius, double normal[3]) {
    const double far = sqrt(gxp_dot(p, p));
    normal[0] = 1; /* across a capsule's axis */
    normal[1] = normal[2] = 0;
    if (far > 0) (void)gxp_unit(p, normal);
    return far - radius;
}

static double gxp_box_distance(const double half[3], const double p[3], double normal[3]) {
    double beyond[3], square = 0;
    int k, most = 0;
    for (k = 0; k < 3; k++) {
        beyond[k] = fabs(p[k]) - half[k];
        if (beyond[k] > beyond[most]) most = k;
        square += beyond[k] > 0 ? beyond[k] * beyond[k] : 0;
    }
    for (k = 0; k < 3; k++)
        normal[k] = square > 0 ? (beyond[k] > 0 ? copysign(beyond[k], p[k]) : 0) : k == most ? copysign(1, p[k]) : 0;
    if (square > 0) (void)gxp_unit(normal, normal);
    return square > 0 ? sqrt(square) : beyond[most];
}

/* Signed distance of a place in the collider's frame; normal: of length 1, or 0 where the caller's has none. Not
   finite: the caller's is not. */
static double gxp_collider_distance(const gx_collider *c, const double p[3], double normal[3]) {
    double d, given[3] = {0, 0, 0}, along;
    switch (c->kind) {
    case GX_COLLIDER_SPHERE: return gxp_ball_distance(p, c->size[0], normal);
    case GX_COLLIDER_CAPSULE:
        along = p[2] > c->size[1] ? c->size[1] : p[2] < -c->size[1] ? -c->size[1] : p[2];
        given[0] = p[0];
        given[1] = p[1];
        given[2] = p[2] - along;
        return gxp_ball_distance(given, c->size[0], normal);
    case GX_COLLIDER_BOX: return gxp_box_distance(c->size, p, normal);
    case GX_COLLIDER_DISTANCE:
        d = c->distance(c->user, p, given);
        normal[0] = normal[1] = normal[2] = 0;
        if (!gxp_is_finite(given[0]) || !gxp_is_finite(given[1]) || !gxp_is_finite(given[2])) return HUGE_VAL;
        (void)gxp_unit(given, normal);
        return d;
    default:
        normal[0] = normal[1] = 0;
        normal[2] = 1;
        return p[2];
    }
}

/* The velocity of a collider at a place in space */
static void gxp_collider_velocity(const gx_collider *c, const double x[3], double velocity[3]) {
    const double arm[3] = {x[0] - c->pose[3], x[1] - c->pose[7], x[2] - c->pose[11]};
    int k;
    gxp_cross(velocity, c->spin, arm);
    for (k = 0; k < 3; k++) velocity[k] += c->velocity[k];
}

/* A direction in space, in the collider's frame, and back */
static void gxp_to_collider(const gx_collider *c, const double x[3], double own[3]) {
    int k;
    for (k = 0; k < 3; k++) own[k] = c->pose[k] * x[0] + c->pose[4 + k] * x[1] + c->pose[8 + k] * x[2];
}
static void gxp_from_collider(const gx_collider *c, const double own[3], double x[3]) {
    int k;
    for (k = 0; k < 3; k++) x[k] = gxp_dot(c->pose + 4 * k, own);
}

/* A sample beside a collider, in the collider's frame */
typedef struct gxp_approach {
    double at[3], motion[3]; /* m, at the step's start; m/s, relative to the collider */
    double normal[3];        /* of the collider where they are nearest */
    double distance, time;   /* m: there; s: then */
    int wild;                /* 1: the caller's distance is not a number */
} gxp_approach;

/* x: position and velocity in space */
static gxp_approach gxp_make_approach(const gx_collider *c, const double x[6]) {
    gxp_approach a;
    double d[3], v[3];
    int k;
    memset(&a, 0, sizeof a);
    gxp_collider_velocity(c, x, v);
    for (k = 0; k < 3; k++) {
        d[k] = x[k] - c->pose[4 * k + 3];
        v[k] = x[3 + k] - v[k];
    }
    gxp_to_collider(c, d, a.at);
    gxp_to_collider(c, v, a.motion);
    return a;
}

/* Does the sample come near its collider within dt? Goes along its way by steps no longer than the distance. */
static int gxp_comes_near(const gx_collider *c, double size, double dt, gxp_approach *a) {
    const double speed = sqrt(gxp_dot(a->motion, a->motion));
    int i, k;
    for (i = 0; i < GXP_TOUCH_ADVANCES; i++) {
        double p[3];
        for (k = 0; k < 3; k++) p[k] = a->at[k] + a->time * a->motion[k];
        a->distance = gxp_collider_distance(c, p, a->normal);
        if (!gxp_is_finite(a->distance)) {
            a->wild = 1;
            return 0;
        }
        if (a->distance < GXP_TOUCH_NEAR * size) return gxp_dot(a->normal, a->normal) > 0;
        if (!(a->distance <= speed * (dt - a->time))) return 0;
        a->time += a->distance / speed;
    }
    return 0;
}

/* Does a sample meet a collider within the step? It then gets the tangent plane of the collider where the two meet,
   moving with the collider. x: position and velocity of the sample. pair: sample, collider, share and area are set;
   receives all else. *wild: 1: the caller's distance is not a number */
static int gxp_meets_collider(const gx_body *body, const double x[6], double size, double dt, gxp_touch_pair *pair,
                              int *wild) {
    const gx_collider *c = &body->touch.colliders[pair->collider];
    gxp_approach a = gxp_make_approach(c, x);
    int k;
    pair->other = c->id;
    if (!gxp_comes_near(c, size, dt, &a)) {
        *wild |= a.wild;
        return 0;
    }
    pair->approach = -gxp_dot(a.normal, a.motion);
    pair->gap = a.distance + a.time * pair->approach;
    gxp_from_collider(c, a.normal, pair->normal);
    for (k = 0; k < 3; k++) pair->place[k] = x[k] - pair->gap * pair->normal[k];
    gxp_collider_velocity(c, pair->place, pair->way);
    for (k = 0; k < 3; k++) pair->way[k] *= dt;
    return 1;
}

/* The length, m, of what a collider may have between samples, at most; an element's size if it is not known */
static double gxp_collider_feature(const gx_collider *c, double size) {
    double least = size;
    int k;
    if (c->kind == GX_COLLIDER_SPHERE || c->kind == GX_COLLIDER_CAPSULE) return c->size[0];
    for (k = 0; k < 3 && c->kind == GX_COLLIDER_BOX; k++) least = fmin(least, 2 * c->size[k]);
    return c->kind == GX_COLLIDER_DISTANCE && c->size[0] > 0 ? c->size[0] : least;
}

/* Into how many parts the edges of a facet are divided for samples beside a collider: 1 where the distance is as good
   as linear on it, so that its corners tell all. 0: it does not come near. */
static uint32_t gxp_facet_parts(const gx_body *body, const gxp_touch_surface *s, double dt, uint32_t facet,
                                const gx_collider *c, int *wild) {
    const gxp_touch_facet *f = &s->facets[facet];
    const double size = s->vertices[f->vertex[0]].size;
    double normal[3][3], center[3] = {0, 0, 0}, reach = 0, nearest = HUGE_VAL, longest = 0, parts;
    gxp_approach corner[3];
    int i, k, bent = 0;
    for (i = 0; i < 3; i++) {
        corner[i] = gxp_make_approach(c, body->touch.moved + 9 * (size_t)f->vertex[i]);
        for (k = 0; k < 3; k++) center[k] += corner[i].at[k] / 3;
    }
    for (i = 0; i < 3; i++) {
        const double *a = corner[i].at, *b = corner[(i + 1) % 3].at, *v = corner[i].motion;
        const double out[3] = {a[0] - center[0], a[1] - center[1], a[2] - center[2]};
        const double edge[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        const double d = gxp_collider_distance(c, a, normal[i]);
        *wild |= !gxp_is_finite(d);
        nearest = fmin(nearest, d);
        reach = fmax(reach, sqrt(gxp_dot(out, out)) + dt * sqrt(gxp_dot(v, v)));
        longest = fmax(longest, sqrt(gxp_dot(edge, edge)));
    }
    for (i = 0; i < 3; i++) bent |= gxp_dot(normal[i], normal[(i + 1) % 3]) < GXP_TOUCH_FLAT;
    if (*wild || !bent) return 1;
    if (nearest > GXP_TOUCH_NEAR * size && gxp_collider_distance(c, center, normal[0]) > reach + GXP_TOUCH_NEAR * size)
        return 0;
    parts = ceil(GXP_TOUCH_FINE * longest / fmax(gxp_collider_feature(c, size), 1e-3 * size));
    return parts < GXP_TOUCH_PARTS ? (uint32_t)fmax(1, parts) : GXP_TOUCH_PARTS;
}

/* Lists a sample for the search of pairs with a collider. */
static gx_result gxp_list_sample(gx_body *body, uint32_t sample, uint32_t collider, uint32_t parts, double area) {
    gxp_touch *t = &body->touch;
    gx_result result =
        gxp_reserve(&body->config.allocator, &t->beside, sizeof *t->beside, t->order.count, &t->beside_capacity, 1);
    if (result == GX_OK) result = gxp_keys_room(body, &t->order, 1);
    if (result != GX_OK) return result;
    t->beside[t->order.count].collider = collider;
    t->beside[t->order.count].parts = parts;
    t->beside[t->order.count].area = area;
    t->order.data[t->order.count] = (uint64_t)sample << 32 | t->order.count;
    t->order.count++;
    return GX_OK;
}

/* Lists the samples of a facet: its corners, each with a third of its area, or the facet, which has many. */
static gx_result gxp_list_samples(gx_body *body, const gxp_touch_surface *s, double dt, uint32_t facet,
                                  uint32_t collider, int *wild) {
    const gxp_touch_facet *f = &s->facets[facet];
    const gx_collider *c = &body->touch.colliders[collider];
    const uint32_t parts = c->kind == GX_COLLIDER_PLANE ? 1 : gxp_facet_parts(body, s, dt, facet, c, wild);
    double n[3], area;
    gx_result result = GX_OK;
    int k;
    gxp_facet_normal(s, f, n);
    area = 0.5 * sqrt(gxp_dot(n, n));
    if (parts > 1) return gxp_list_sample(body, s->vertex_count + facet, collider, parts, area);
    for (k = 0; k < 3 && parts == 1 && result == GX_OK; k++)
        result = gxp_list_sample(body, f->vertex[k], collider, 1, area / 3);
    return result;
}

/* Lists the samples in boxes that a collider may come near to within the step. */
static gx_result gxp_list_beside(gx_body *body, const gxp_touch_surface *s, double dt, uint32_t collider, int *wild) {
    const gxp_touch *t = &body->touch;
    const gx_collider *c = &t->colliders[collider];
    const double turn = sqrt(gxp_dot(c->spin, c->spin)), speed = sqrt(gxp_dot(c->velocity, c->velocity));
    uint32_t stack[64], count = 0, i;
    gx_result result = GX_OK;
    stack[count++] = 0;
    while (count > 0 && result == GX_OK) {
        const uint32_t box = stack[--count];
        gxp_bounds around = t->boxes[box].from;
        const gxp_bounds *b = &around;
        double x[3], own[3], normal[3], half = 0, far, d;
        int k;
        gxp_add_bounds(&around, &t->boxes[box].to);
        if (b->low[0] > b->high[0]) continue;
        for (k = 0; k < 3; k++) {
            x[k] = 0.5 * (b->low[k] + b->high[k]) - c->pose[4 * k + 3];
            half += 0.25 * (b->high[k] - b->low[k]) * (b->high[k] - b->low[k]);
        }
        half = sqrt(half);
        far = sqrt(gxp_dot(x, x));
        gxp_to_collider(c, x, own);
        d = gxp_collider_distance(c, own, normal);
        if (!gxp_is_finite(d)) {
            *wild = 1;
            return result;
        }
        if (d > half + GXP_TOUCH_NEAR * s->largest + dt * (speed + turn * (far + half))) continue;
        if (box + 1 < t->leaf_count) {
            stack[count++] = 2 * box + 2;
            stack[count++] = 2 * box + 1;
            continue;
        }
        for (i = GXP_TOUCH_LEAF * (box + 1 - t->leaf_count);
             i < GXP_TOUCH_LEAF * (box + 2 - t->leaf_count) && i < s->facet_count && result == GX_OK; i++)
            result = gxp_list_samples(body, s, dt, i, collider, wild);
    }
    return result;
}

/* Lists the samples beside colliders by sample: touch.order, second: place in touch.beside. */
static gx_result gxp_list_all_beside(gx_body *body, const gxp_touch_surface *s, double dt, gx_failure *failure) {
    gx_result result = GX_OK;
    uint32_t i;
    body->touch.order.count = 0;
    for (i = 0; i < body->touch.collider_count && s->facet_count > 0 && result == GX_OK; i++) {
        int wild = 0;
        result = gxp_list_beside(body, s, dt, i, &wild);
        if (wild) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "colliders.distance", i);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, &body->touch.order, 0, body->touch.order.count);
    return gxp_end(failure, result);
}

static gx_result gxp_check_collider(const gx_collider *c, size_t index, gx_failure *failure) {
    static const char *const names[5] = {"colliders.size", "colliders.pose", "colliders.velocity", "colliders.spin",
                                         "colliders.friction"};
    static const int sizes[5] = {0, 1, 2, 3, 1}; /* by kind: numbers of size that are read */
    const double *const numbers[5] = {c->size, c->pose, c->velocity, c->spin, &c->friction};
    const int counts[5] = {c->kind < 5 ? sizes[c->kind] : 0, 12, 3, 3, 1};
    double turned[3];
    int i, k;
    if (c->id == GXP_NONE) return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.id", index);
    if (c->kind > GX_COLLIDER_DISTANCE) return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.kind", index);
    for (i = 0; i < 5; i++)
        for (k = 0; k < counts[i]; k++) {
            if (!gxp_is_finite(numbers[i][k])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, names[i], index);
            if ((i == 0 || i == 4) && numbers[i][k] < 0) return gxp_fail(failure, GX_ERROR_ARGUMENT, names[i], index);
        }
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++)
            if (fabs(gxp_dot(c->pose + 4 * i, c->pose + 4 * k) - (i == k)) > 1e-6)
                return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.pose", index);
    gxp_cross(turned, c->pose, c->pose + 4);
    if (gxp_dot(turned, c->pose + 8) < 0) return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.pose", index);
    if (c->kind == GX_COLLIDER_DISTANCE && c->distance == NULL)
        return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.distance", index);
    return GX_OK;
}

/* Hash of a collider's shape and pose */
static uint64_t gxp_hash_collider(const gx_collider *c) {
    uint64_t hash = gxp_hash_words(1, &c->kind, 1);
    hash = gxp_hash_doubles(hash, c->size, 3);
    hash = gxp_hash_doubles(hash, c->pose, 12);
    return gxp_hash_doubles(hash, &c->friction, 1);
}

/* Is a collider other than in the last step, or will it be after this one? */
static int gxp_is_changed(const gxp_touch *t, const gx_collider *c) {
    uint32_t low = 0, high = t->known_count;
    if (gxp_dot(c->velocity, c->velocity) > 0 || gxp_dot(c->spin, c->spin) > 0) return 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (t->known[middle].id < c->id)
            low = middle + 1;
        else
            high = middle;
    }
    return low == t->known_count || t->known[low].id != c->id || t->known[low].hash != gxp_hash_collider(c);
}

/* Takes the colliders of a step: checks, names and compares them. */
static gx_result gxp_take_colliders(gx_body *body, const gx_step_desc *desc, gx_failure *failure) {
    gxp_touch *t = &body->touch;
    const size_t count = desc->collider_count;
    gx_result result = GX_OK;
    uint32_t i;
    t->colliders = desc->colliders;
    t->filter = desc->contact_filter;
    t->filter_user = desc->contact_filter_user;
    t->collider_count = t->named.count = t->changed.count = 0;
    if (count == 0) return GX_OK;
    if (desc->colliders == NULL) return gxp_refuse(failure, "colliders");
    if (count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "collider_count", SIZE_MAX);
    for (i = 0; i < count && result == GX_OK; i++) result = gxp_check_collider(&desc->colliders[i], i, failure);
    if (result != GX_OK) return result;
    result = gxp_keys_room(body, &t->named, 2 * count);
    if (result == GX_OK) result = gxp_words_room(body, &t->changed, count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &t->known, sizeof *t->known, t->known_count, &t->known_capacity,
                             count > t->known_count ? count - t->known_count : 0);
    for (i = 0; i < count && result == GX_OK; i++) {
        t->named.data[t->named.count++] = (uint64_t)desc->colliders[i].id << 32 | i;
        t->changed.data[t->changed.count++] = (uint32_t)gxp_is_changed(t, &desc->colliders[i]);
    }
    if (result == GX_OK) result = gxp_sort_keys(body, &t->named, 0, t->named.count);
    if (gxp_end(failure, result) != GX_OK) return result;
    for (i = 1; i < count; i++)
        if (GXP_FIRST(t->named.data[i]) == GXP_FIRST(t->named.data[i - 1]))
            return gxp_fail(failure, GX_ERROR_ARGUMENT, "colliders.id", GXP_SECOND(t->named.data[i]));
    t->collider_count = (uint32_t)count;
    return GX_OK;
}

/* After a step: remembers its colliders. */
static void gxp_know_colliders(gxp_touch *t) {
    uint32_t i;
    t->known_count = t->collider_count;
    for (i = 0; i < t->collider_count; i++) {
        const gx_collider *c = &t->colliders[GXP_SECOND(t->named.data[i])];
        t->known[i].id = c->id;
        t->known[i].unused = 0;
        t->known[i].hash = gxp_hash_collider(c);
    }
}

/* Is a collider gone, or other than in the last step? */
static int gxp_has_changed(const gxp_touch *t, uint32_t id) {
    const uint32_t i = gxp_first_key(&t->named, (uint64_t)id << 32);
    return i == t->named.count || GXP_FIRST(t->named.data[i]) != id || t->changed.data[GXP_SECOND(t->named.data[i])];
}

/* >>meeting: does a vertex meet a facet? --------------------------------------------------------------------------- */
/* In: the surface, where its material is and how fast. Out: for a vertex and a facet, what they are to each other
   within a step. Touches positions and normals of a step with contact. */

/* A vertex touches at most one facet, in whose frame all is told: the gap is the vertex's height above the facet's
   plane. Pairs stay what they are within the step, so that its energy is well defined. A pair without load, in front of
   its facet, is there in time for what comes near within the step. */

/* A cosine: facets that face a vertex less do not meet it. */
#define GXP_TOUCH_FACING 0.5
/* In sizes of an element: how far beside a facet a vertex may be, with a share of its gap; from how far a sample of a
   facet takes the state of another one; how far behind a facet at rest is a piece's own thickness */
#define GXP_TOUCH_BESIDE 0.002
#define GXP_TOUCH_SLANT  0.1
#define GXP_TOUCH_SAME   0.25
#define GXP_TOUCH_BEHIND 1e-9

/* What the affine rate of a copy adds to the velocity of a material point along an axis; 0 where it has none */
static double gxp_affine_speed(const gx_body *body, uint32_t copy, const double rest[3], int axis) {
    const double *x = body->mesh.positions + 3 * (size_t)body->copies.node[copy];
    double speed = 0;
    int j;
    for (j = 0; j < 3 && body->copies.affine != NULL && body->copies.affine[copy]; j++)
        speed += body->copies.linear_rate[9 * (size_t)copy + 3 * (size_t)j + (size_t)axis] * (rest[j] - x[j]);
    return speed;
}

/* Position, velocity and normal of all vertices, normals of facets */
static void gxp_move_surface(gx_body *body, const gxp_touch_surface *s) {
    double *moved = body->touch.moved;
    uint32_t i;
    int n, k;
    for (i = 0; i < s->vertex_count; i++) {
        const gxp_touch_vertex *v = &s->vertices[i];
        double *x = moved + 9 * (size_t)i;
        gxp_map_point(body, v->rest, v->copies, v->weights, 4, x);
        for (k = 3; k < 9; k++) x[k] = 0;
        for (n = 0; n < 4 && v->weights[n] > 0; n++)
            for (k = 0; k < 3; k++)
                x[3 + k] += v->weights[n] * (body->copies.velocity[3 * (size_t)v->copies[n] + (size_t)k] +
                                             gxp_affine_speed(body, v->copies[n], v->rest, k));
    }
    for (i = 0; i < s->facet_count; i++) {
        static const uint32_t corner[3] = {0, 1, 2};
        double x[9], n_area[3], *unit = body->touch.facing + 3 * (size_t)i;
        for (n = 0; n < 3; n++) memcpy(x + 3 * n, moved + 9 * (size_t)s->facets[i].vertex[n], 3 * sizeof *x);
        gxp_triangle_normal(x, corner, n_area);
        unit[0] = unit[1] = unit[2] = 0;
        (void)gxp_unit(n_area, unit);
        for (n = 0; n < 3; n++)
            for (k = 0; k < 3; k++) moved[9 * (size_t)s->facets[i].vertex[n] + 6 + (size_t)k] += n_area[k];
    }
    for (i = 0; i < s->vertex_count; i++) {
        double unit[3] = {0, 0, 0};
        (void)gxp_unit(moved + 9 * (size_t)i + 6, unit);
        memcpy(moved + 9 * (size_t)i + 6, unit, sizeof unit);
    }
}

/* Is what is between a vertex and a facet the piece itself? They were near each other at rest, and did not face each
   other, or the vertex was behind the facet. */
static int gxp_is_thickness(const gxp_touch_surface *s, const gxp_touch_vertex *v, const gxp_touch_facet *f,
                            const double share[3], double reach) {
    double d[3], n[3], unit[3];
    int i, k;
    for (k = 0; k < 3; k++) {
        d[k] = v->rest[k];
        for (i = 0; i < 3; i++) d[k] -= share[i] * s->vertices[f->vertex[i]].rest[k];
    }
    if (gxp_dot(d, d) > 4 * reach * reach) return 0;
    gxp_facet_normal(s, f, n);
    return !gxp_unit(n, unit) || gxp_dot(v->normal, unit) > -GXP_TOUCH_FACING ||
           gxp_dot(d, unit) < -GXP_TOUCH_BEHIND * v->size;
}

/* How far from a vertex facets that it meets are at most, m */
static double gxp_touch_slack(const gxp_touch *t, const gxp_touch_vertex *v) {
    return (t->desc.depth * (1 + GXP_TOUCH_SLANT) + GXP_TOUCH_NEAR + GXP_TOUCH_BESIDE) * v->size;
}

/* The same of facets that it is in front of, when it comes nearest to them */
static double gxp_touch_ahead(const gxp_touch_vertex *v) {
    return (GXP_TOUCH_NEAR * (1 + GXP_TOUCH_SLANT) + GXP_TOUCH_BESIDE) * v->size;
}

/* The height of a place above the plane through a corner of a facet */
static double gxp_height_above(const double *x, const double *corner, const double n[3]) {
    return n[0] * (x[0] - corner[0]) + n[1] * (x[1] - corner[1]) + n[2] * (x[2] - corner[2]);
}

/* The least and the most of three numbers */
static void gxp_range_of(double a, double b, double c, double *low, double *high) {
    const double least = a < b ? a : b, most = a < b ? b : a;
    *low = least < c ? least : c;
    *high = most > c ? most : c;
}

/* The speed at which a vertex comes nearer to a facet */
static double gxp_approach_facet(const double *x, const double *const corner[3], const double n[3]) {
    double approach = 0;
    int k;
    for (k = 0; k < 3; k++)
        approach -= n[k] * (x[3 + k] - (corner[0][3 + k] + corner[1][3 + k] + corner[2][3 + k]) / 3);
    return approach;
}

/* May a vertex meet a facet within the step, with a score of at most limit? The quick test before gxp_meets. */
static int gxp_may_meet(const gxp_touch *t, const gxp_touch_surface *s, double dt, uint32_t vertex, uint32_t facet,
                        double limit) {
    const gxp_touch_facet *f = &s->facets[facet];
    const double *x = t->moved + 9 * (size_t)vertex, *n = t->facing + 3 * (size_t)facet, *corner[3];
    const double facing = -gxp_dot(x + 6, n), size = s->vertices[vertex].size, bit = 1e-9 * size;
    double height, far, approach;
    int i;
    if (!(facing > GXP_TOUCH_FACING)) return 0;
    height = gxp_height_above(x, t->moved + 9 * (size_t)f->vertex[0], n);
    far = fabs(height) - bit;
    if (!(height > -t->desc.depth * size - bit) || (far > 0 && far * far > limit)) return 0;
    for (i = 0; i < 3; i++) {
        if (f->vertex[i] == vertex) return 0;
        corner[i] = t->moved + 9 * (size_t)f->vertex[i];
    }
    if (height < GXP_TOUCH_NEAR * size) return 1;
    approach = gxp_approach_facet(x, corner, n);
    return height - (approach > 0 ? dt * approach : 0) < GXP_TOUCH_NEAR * size + bit;
}

/* May the origin be so near a triangle, and so little beside it? The quick test before the nearest place is found. p:
   its corners, n: its normal */
static int gxp_may_be_near(double p[3][3], const double n[3], double near, double beside) {
    const double a = gxp_dot(p[0], n), b = gxp_dot(p[1], n), c = gxp_dot(p[2], n);
    double low, high, most;
    int k, far = 0;
    gxp_range_of(a, b, c, &low, &high);
    most = high > -low ? high : -low;
    beside += GXP_TOUCH_SLANT * most;
    for (k = 0; k < 3; k++) {
        gxp_range_of(p[0][k], p[1][k], p[2][k], &low, &high);
        far |= (low > near) | (high < -near);
        gxp_range_of(p[0][k] - a * n[k], p[1][k] - b * n[k], p[2][k] - c * n[k], &low, &high);
        far |= (low > beside) | (high < -beside);
    }
    return !far;
}

/* Does a vertex meet a facet within the step, with a score of at most pair.score? pair: its vertex and facet are set;
   receives all else. Where the two come near each other, the place is the one where the vertex will be when the gap is
   closed. */
static int gxp_meets(const gx_body *body, const gxp_touch_surface *s, double dt, gxp_touch_pair *pair) {
    const gxp_touch *t = &body->touch;
    const gxp_touch_vertex *v = &s->vertices[pair->sample];
    const gxp_touch_facet *f = &s->facets[pair->facet];
    const double *x = t->moved + 9 * (size_t)pair->sample, *n = t->facing + 3 * (size_t)pair->facet;
    const double facing = -gxp_dot(x + 6, n), bit = 1e-9 * v->size, *corner[3];
    double p[3][3], y[3], d[3], height, time = 0, along, square, slack, near, reach;
    int i, k;
    for (i = 0; i < 3; i++) corner[i] = t->moved + 9 * (size_t)f->vertex[i];
    height = gxp_height_above(x, corner[0], n);
    slack = height > 0 ? gxp_touch_ahead(v) : gxp_touch_slack(t, v);
    pair->approach = height > 0 ? gxp_approach_facet(x, corner, n) : 0;
    if (pair->approach > 0) time = height < dt * pair->approach ? height / pair->approach : dt;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) p[i][k] = corner[i][k] - x[k] + time * (corner[i][3 + k] - x[3 + k]);
    near = sqrt(pair->score);
    near = near < slack ? near : slack;
    if (!gxp_may_be_near(p, n, near + bit, GXP_TOUCH_BESIDE * v->size + bit)) return 0;
    pair->share[0] = pair->share[1] = pair->share[2] = 0;
    (void)gxp_near_triangle(p, GXP_TREE_ALL, pair->share);
    for (k = 0; k < 3; k++) {
        y[k] = pair->share[0] * p[0][k] + pair->share[1] * p[1][k] + pair->share[2] * p[2][k];
        d[k] = x[k] - pair->share[0] * corner[0][k] - pair->share[1] * corner[1][k] - pair->share[2] * corner[2][k];
        pair->normal[k] = n[k];
    }
    if (!(height > 0)) pair->approach = gxp_approach_facet(x, corner, n);
    pair->gap = gxp_dot(d, n);
    height = gxp_dot(y, n);
    square = gxp_dot(y, y);
    along = square > height * height ? sqrt(square - height * height) : 0;
    reach = t->desc.depth * fmin(v->size, s->vertices[f->vertex[0]].size);
    if (!(pair->gap > -reach * facing) ||
        !(pair->gap - (pair->approach > 0 ? dt * pair->approach : 0) < GXP_TOUCH_NEAR * v->size) ||
        !(along <= GXP_TOUCH_BESIDE * v->size + GXP_TOUCH_SLANT * fabs(height)) || !(square < slack * slack))
        return 0;
    pair->score = (square + pair->gap * pair->gap) / (facing * facing);
    return v->fragment != f->fragment || !gxp_is_thickness(s, v, f, pair->share, reach);
}

/* Do two pieces touch, or a piece and a collider, if they meet? */
static int gxp_is_let(const gxp_touch *t, uint32_t fragment, uint32_t other, uint32_t collider) {
    return t->filter == NULL || t->filter(t->filter_user, fragment, other, collider);
}

/* Tries one facet; of equal ones the first in the surface's order is taken. */
static void gxp_try_facet(const gx_body *body, const gxp_touch_surface *s, double dt, uint32_t facet,
                          gxp_touch_pair *best) {
    gxp_touch_pair pair;
    if (!gxp_may_meet(&body->touch, s, dt, best->sample, facet, best->score)) return;
    if (!gxp_is_let(&body->touch, s->vertices[best->sample].fragment, s->facets[facet].fragment, GXP_NONE)) return;
    pair.sample = best->sample;
    pair.facet = facet;
    pair.score = best->score;
    if (!gxp_meets(body, s, dt, &pair) || pair.score > best->score ||
        (!(pair.score < best->score) && facet > best->facet))
        return;
    best->facet = facet;
    best->gap = pair.gap;
    best->approach = pair.approach;
    best->score = pair.score;
    memcpy(best->share, pair.share, sizeof best->share);
    memcpy(best->normal, pair.normal, sizeof best->normal);
}

/* >>seeking: the pairs of a step ----------------------------------------------------------------------------------- */
/* In: the surface, where its material is and how fast. Out: the pairs that a step gets beside the caller's. Touches
   what a step with contact works with. */

/* A tree of boxes over the facets, in their order. Samples that are near each other and face alike go through it
   together: down to what all of many may meet, from there to what a few may meet, then each for itself, with the facet
   of the last step as the first bound. What is left out cannot be met, or is further than what is found: so a sample
   meets the same facet as by trying all. */

/* Samples that are sought together, at most: those that leave out boxes together first, then those that list leaves
   together. With half or twice of either a step takes up to 4 % longer. A cosine: how alike they face at rest */
enum { GXP_TOUCH_MANY = 64, GXP_TOUCH_FEW = 16 };
#define GXP_TOUCH_ALIKE 0.7

/* Adds a point or a direction to bounds. */
static void gxp_add_to_bounds(const double *x, gxp_bounds *box) {
    int k;
    for (k = 0; k < 3; k++) {
        box->low[k] = x[k] < box->low[k] ? x[k] : box->low[k];
        box->high[k] = x[k] > box->high[k] ? x[k] : box->high[k];
    }
}

/* Where a vertex is at the step's end if nothing changes its velocity */
static void gxp_vertex_end(const double *moved, double dt, double end[3]) {
    int k;
    for (k = 0; k < 3; k++) end[k] = moved[k] + dt * moved[3 + k];
}

/* Fits the boxes to the facets. */
static void gxp_fit_facets(gx_body *body, const gxp_touch_surface *s, double dt) {
    gxp_touch *t = &body->touch;
    uint32_t i, j;
    int n;
    for (i = 2 * t->leaf_count - 1; i-- > 0;) {
        gxp_touch_box *box = &t->boxes[i];
        gxp_empty_bounds(&box->from);
        gxp_empty_bounds(&box->to);
        gxp_empty_bounds(&box->normals);
        for (j = 2 * i + 1; j <= 2 * i + 2 && i + 1 < t->leaf_count; j++) {
            gxp_add_bounds(&box->from, &t->boxes[j].from);
            gxp_add_bounds(&box->to, &t->boxes[j].to);
            gxp_add_bounds(&box->normals, &t->boxes[j].normals);
        }
        if (i + 1 < t->leaf_count) continue;
        for (j = GXP_TOUCH_LEAF * (i + 1 - t->leaf_count);
             j < GXP_TOUCH_LEAF * (i + 2 - t->leaf_count) && j < s->facet_count; j++) {
            gxp_add_to_bounds(t->facing + 3 * (size_t)j, &box->normals);
            for (n = 0; n < 3; n++) {
                const double *x = t->moved + 9 * (size_t)s->facets[j].vertex[n];
                double end[3];
                gxp_vertex_end(x, dt, end);
                gxp_add_to_bounds(x, &box->from);
                gxp_add_to_bounds(end, &box->to);
            }
        }
    }
}

/* The least and the most of products of numbers from two ranges */
static void gxp_range_product(double a, double b, double c, double d, double *low, double *high) {
    const double ac = a * c, ad = a * d, bc = b * c, bd = b * d;
    const double least = ac < ad ? ac : ad, most = ac < ad ? ad : ac, one = bc < bd ? bc : bd,
                 other = bc < bd ? bd : bc;
    *low = least < one ? least : one;
    *high = most < other ? other : most;
}

/* The squared distance of a box from samples within the step; GXP_TREE_BEYOND if it is above limit or if none of them
   meets a facet there. A way y from a sample to the place of a facet that it meets has a height h = y.n over the
   sample, -ahead <= h <= slack, and |y - h n| <= beside + slant |h|. */
static double gxp_box_gap(const gxp_touch_box *box, const gxp_touch_crowd *crowd, double limit) {
    const gxp_touch_box *own = &crowd->own;
    double low[3], high[3], square = 0, facing = 0, least = 0, most = 0, width;
    int k;
    for (k = 0; k < 3; k++) {
        const double left = box->from.low[k] - own->from.high[k], right = box->from.high[k] - own->from.low[k];
        const double left_end = box->to.low[k] - own->to.high[k], right_end = box->to.high[k] - own->to.low[k];
        double gap;
        low[k] = left < left_end ? left : left_end;
        high[k] = right > right_end ? right : right_end;
        gap = low[k] > -high[k] ? low[k] : -high[k];
        square += gap > 0 ? gap * gap : 0;
    }
    if (square > limit) return GXP_TREE_BEYOND;
    for (k = 0; k < 3; k++) {
        const double *n = box->normals.low + k, *m = box->normals.high + k;
        double one, other;
        gxp_range_product(own->normals.low[k], own->normals.high[k], *n, *m, &one, &other);
        facing -= one;
        gxp_range_product(low[k], high[k], *n, *m, &one, &other);
        least += one;
        most += other;
    }
    if (facing < GXP_TOUCH_FACING * (1 - 1e-9)) return GXP_TREE_BEYOND;
    least -= 1e-9 * crowd->size;
    most += 1e-9 * crowd->size;
    if (most < -crowd->ahead || (most < 0 && square > crowd->ahead * crowd->ahead)) return GXP_TREE_BEYOND;
    least = least > -crowd->ahead ? least : -crowd->ahead;
    most = most < crowd->slack ? most : crowd->slack;
    width = crowd->beside + GXP_TOUCH_SLANT * (most > -least ? most : -least);
    for (k = 0; k < 3; k++) {
        double one, other;
        gxp_range_product(least, most, box->normals.low[k], box->normals.high[k], &one, &other);
        if (low[k] > other + width || high[k] < one - width) return GXP_TREE_BEYOND;
    }
    return square;
}

/* Starts a crowd without samples. */
static void gxp_start_crowd(gxp_touch_crowd *crowd) {
    gxp_empty_bounds(&crowd->own.from);
    gxp_empty_bounds(&crowd->own.to);
    gxp_empty_bounds(&crowd->own.normals);
    crowd->slack = crowd->ahead = crowd->beside = crowd->size = 0;
}

/* Adds a sample to a crowd. */
static void gxp_join_crowd(const gxp_touch *t, const gxp_touch_surface *s, double dt, uint32_t sample,
                           gxp_touch_crowd *crowd) {
    const gxp_touch_vertex *v = &s->vertices[sample];
    const double *x = t->moved + 9 * (size_t)sample, more = 1 + 1e-9;
    double end[3];
    gxp_vertex_end(x, dt, end);
    gxp_add_to_bounds(x, &crowd->own.from);
    gxp_add_to_bounds(end, &crowd->own.to);
    gxp_add_to_bounds(x + 6, &crowd->own.normals);
    if (!(v->size > crowd->size)) return; /* all reaches grow with the size */
    crowd->size = v->size;
    crowd->slack = gxp_touch_slack(t, v) * more;
    crowd->ahead = gxp_touch_ahead(v) * more;
    crowd->beside = GXP_TOUCH_BESIDE * v->size + 1e-9 * v->size;
}

/* Finds the boxes in and below those of `from`, or below the root, that may hold what a crowd meets: those of a level
   of the tree with `level` boxes. */
static gx_result gxp_narrow_boxes(gx_body *body, const gxp_touch_crowd *crowd, const gxp_words *from, uint32_t level,
                                  gxp_words *found) {
    const gxp_touch_box *boxes = body->touch.boxes;
    const double limit = crowd->slack * crowd->slack;
    uint32_t stack[64], count, i;
    gx_result result = GX_OK;
    found->count = 0;
    for (i = 0; i < (from != NULL ? from->count : 1) && result == GX_OK; i++) {
        stack[0] = from != NULL ? from->data[i] : 0;
        for (count = 1; count > 0 && result == GX_OK;) {
            const uint32_t box = stack[--count];
            if (gxp_box_gap(&boxes[box], crowd, limit) > limit) continue;
            if (box + 1 >= level) {
                result = gxp_push(body, found, box);
                continue;
            }
            stack[count++] = 2 * box + 2;
            stack[count++] = 2 * box + 1;
        }
    }
    return result;
}

/* A pair of a sample that touches nothing so far */
static gxp_touch_pair gxp_no_pair(uint32_t sample) {
    gxp_touch_pair pair;
    memset(&pair, 0, sizeof pair);
    pair.sample = sample;
    pair.facet = pair.collider = pair.other = GXP_NONE;
    pair.score = GXP_TREE_ALL;
    return pair;
}

/* How far from a sample a better facet than that of its pair may be at most, m */
static double gxp_pair_slack(const gxp_touch_surface *s, const gxp_touch_pair *best, double slack) {
    const double near = sqrt(best->score) + 1e-9 * s->vertices[best->sample].size;
    return near < slack ? near : slack;
}

/* The boxes of touch.near from the step's start to its end, as a crowd sees them that moves by `shift` within the step:
   touch.passed, low[3] and high[3], each of all boxes */
static gx_result gxp_list_passed(gx_body *body, const double shift[3]) {
    gxp_touch *t = &body->touch;
    const uint32_t n = t->near.count;
    uint32_t i;
    int k;
    const gx_result result =
        gxp_reserve(&body->config.allocator, &t->passed, sizeof *t->passed, 0, &t->passed_capacity, 6 * (size_t)n);
    for (i = 0; i < n && result == GX_OK; i++) {
        const gxp_touch_box *box = &t->boxes[t->near.data[i]];
        for (k = 0; k < 3; k++) {
            const double low = box->to.low[k] - shift[k], high = box->to.high[k] - shift[k];
            t->passed[(size_t)n * (size_t)k + i] = box->from.low[k] < low ? box->from.low[k] : low;
            t->passed[(size_t)n * (size_t)(3 + k) + i] = box->from.high[k] > high ? box->from.high[k] : high;
        }
    }
    return result;
}

/* Finds the leaves of touch.near that are within reach of a sample: `kept`. Returns how many */
static uint32_t gxp_keep_leaves(const gxp_touch *t, const gxp_touch_box *own, const double shift[3], double reach,
                                uint32_t *kept) {
    const uint32_t n = t->near.count;
    const double *low = t->passed, *high = t->passed + 3 * (size_t)n;
    double from[3], to[3];
    uint32_t i, count = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const double end = own->to.low[k] - shift[k];
        from[k] = (own->from.low[k] < end ? own->from.low[k] : end) - reach;
        to[k] = (own->from.low[k] > end ? own->from.low[k] : end) + reach;
    }
    for (i = 0; i < n; i++) {
        kept[count] = t->near.data[i];
        count += (uint32_t)((low[i] <= to[0]) & (low[n + i] <= to[1]) & (low[2 * n + i] <= to[2]) &
                            (high[i] >= from[0]) & (high[n + i] >= from[1]) & (high[2 * n + i] >= from[2]));
    }
    return count;
}

/* Finds the facet that a vertex meets among those of touch.near. best: its vertex, and a facet that it meets or
   GXP_NONE; receives the best one. What is found leaves out all that is further. */
static void gxp_seek_facet(const gx_body *body, const gxp_touch_surface *s, double dt, const double shift[3],
                           gxp_touch_pair *best) {
    const gxp_touch *t = &body->touch;
    uint32_t *kept = t->kept_leaves.data, count, i, j;
    gxp_touch_crowd crowd;
    gxp_start_crowd(&crowd);
    gxp_join_crowd(t, s, dt, best->sample, &crowd);
    count = gxp_keep_leaves(t, &crowd.own, shift, gxp_pair_slack(s, best, crowd.slack) + 1e-9 * crowd.size, kept);
    for (i = 0; i < count; i++) {
        const double slack = gxp_pair_slack(s, best, crowd.slack), limit = slack * slack;
        const uint32_t leaf = kept[i] + 1 - t->leaf_count;
        if (gxp_box_gap(&t->boxes[kept[i]], &crowd, limit) > limit) continue;
        for (j = GXP_TOUCH_LEAF * leaf; j < GXP_TOUCH_LEAF * (leaf + 1) && j < s->facet_count; j++)
            gxp_try_facet(body, s, dt, j, best);
    }
}

/* Finds the facets that a few samples meet: surface.guesses. touch.crowd: boxes in which they are. What they met when
   they were sought last comes first. */
static gx_result gxp_seek_few(gx_body *body, const gxp_touch_surface *s, double dt, const uint32_t *samples,
                              uint32_t count) {
    gxp_touch *t = &body->touch;
    gxp_touch_pair best[GXP_TOUCH_FEW];
    gxp_touch_crowd crowd;
    double slack = 0, shift[3];
    uint32_t i;
    int k;
    gx_result result;
    gxp_start_crowd(&crowd);
    for (i = 0; i < count; i++) {
        const uint32_t guess = s->guesses.data[samples[i]];
        best[i] = gxp_no_pair(samples[i]);
        gxp_join_crowd(t, s, dt, samples[i], &crowd);
        if (guess != GXP_NONE) gxp_try_facet(body, s, dt, guess, &best[i]);
        slack = fmax(slack, gxp_pair_slack(s, &best[i], gxp_touch_slack(t, &s->vertices[samples[i]])));
    }
    crowd.slack = slack * (1 + 1e-9);
    result = gxp_narrow_boxes(body, &crowd, &t->crowd, t->leaf_count, &t->near);
    for (k = 0; k < 3; k++)
        shift[k] = 0.5 * (crowd.own.to.low[k] + crowd.own.to.high[k] - crowd.own.from.low[k] - crowd.own.from.high[k]);
    if (result == GX_OK) result = gxp_start_words(body, &t->kept_leaves, t->near.count + 1);
    if (result == GX_OK) result = gxp_list_passed(body, shift);
    for (i = 0; i < count && result == GX_OK; i++) {
        if (t->near.count > 0) gxp_seek_facet(body, s, dt, shift, &best[i]);
        s->guesses.data[samples[i]] = best[i].facet;
    }
    return result;
}

/* How many of the samples from `first` on, at most `most`, are of one piece and face alike? */
static uint32_t gxp_crowd_size(const gxp_touch_surface *s, const uint32_t *samples, uint32_t left, uint32_t most) {
    const gxp_touch_vertex *v = &s->vertices[samples[0]];
    uint32_t i;
    for (i = 1; i < left && i < most; i++) {
        const gxp_touch_vertex *w = &s->vertices[samples[i]];
        if (v->fragment != w->fragment || gxp_dot(v->normal, w->normal) < GXP_TOUCH_ALIKE) break;
    }
    return i;
}

/* Finds the facets that all samples meet. Boxes that none of many samples meets are left out for all of them at once,
   then those that none of a few meets. */
static gx_result gxp_seek_facets(gx_body *body, const gxp_touch_surface *s, double dt) {
    gxp_touch *t = &body->touch;
    const uint32_t count = s->samples.count, *samples = s->samples.data;
    uint32_t first, i, n, few;
    gx_result result = GX_OK;
    for (first = 0; first < count && result == GX_OK; first += n) {
        gxp_touch_crowd crowd;
        gxp_start_crowd(&crowd);
        n = gxp_crowd_size(s, samples + first, count - first, GXP_TOUCH_MANY);
        for (i = first; i < first + n; i++) gxp_join_crowd(t, s, dt, samples[i], &crowd);
        result = gxp_narrow_boxes(body, &crowd, NULL, t->leaf_count / 8, &t->crowd);
        if (t->crowd.count == 0)
            for (i = first; i < first + n; i++) s->guesses.data[samples[i]] = GXP_NONE;
        for (i = 0; i < n && t->crowd.count > 0 && result == GX_OK; i += few) {
            few = gxp_crowd_size(s, samples + first + i, n - i, GXP_TOUCH_FEW);
            result = gxp_seek_few(body, s, dt, samples + first + i, few);
        }
    }
    return result;
}

/* The vertex by whose element a sample is measured */
static const gxp_touch_vertex *gxp_sample_vertex(const gxp_touch_surface *s, uint32_t sample) {
    return &s->vertices[sample < s->vertex_count ? sample : s->facets[sample - s->vertex_count].vertex[0]];
}

/* What a pair's sample pressed with before. A facet has many samples: the nearest one counts, which after a cut need
   not be where it was. */
static void gxp_recall_state(const gxp_touch_surface *s, gxp_touch_pair *pair) {
    const double size = gxp_sample_vertex(s, pair->sample)->size;
    double best = GXP_TOUCH_SAME * size * GXP_TOUCH_SAME * size;
    uint32_t i;
    for (i = gxp_first_state(s, pair->sample); i < s->state_count && s->states[i].sample == pair->sample; i++) {
        const gxp_touch_state *state = &s->states[i];
        const double d[3] = {state->rest[0] - pair->rest[0], state->rest[1] - pair->rest[1],
                             state->rest[2] - pair->rest[2]};
        const double square = pair->sample < s->vertex_count ? 0 : gxp_dot(d, d);
        if (state->other != pair->other || !(square < best)) continue;
        best = square;
        pair->pressed = state->pressed;
        memcpy(pair->slip, state->slip, sizeof pair->slip);
        if (!(best > 0)) return;
    }
}

/* Lists a pair with what its sample pressed with. */
static gx_result gxp_list_pair(gx_body *body, const gxp_touch_surface *s, const gxp_touch_pair *pair,
                               gx_failure *failure) {
    gxp_touch *t = &body->touch;
    gx_result result;
    if (t->desc.max_pairs > 0 && t->found >= t->desc.max_pairs)
        return gxp_fail(failure, GX_ERROR_LIMIT, "max_pairs", SIZE_MAX);
    result = gxp_reserve(&body->config.allocator, &t->pairs, sizeof *t->pairs, t->found, &t->pair_capacity, 1);
    if (result != GX_OK) return gxp_end(failure, result);
    t->pairs[t->found] = *pair;
    gxp_recall_state(s, &t->pairs[t->found++]);
    return GX_OK;
}

/* Lists the pair of a vertex with a collider, if they meet. */
static gx_result gxp_seek_at_vertex(gx_body *body, const gxp_touch_surface *s, double dt, gxp_touch_pair *pair,
                                    gx_failure *failure) {
    const gxp_touch_vertex *v = &s->vertices[pair->sample];
    int wild = 0;
    memcpy(pair->rest, v->rest, sizeof pair->rest);
    if (gxp_meets_collider(body, body->touch.moved + 9 * (size_t)pair->sample, v->size, dt, pair, &wild))
        return gxp_list_pair(body, s, pair, failure);
    return wild ? gxp_fail(failure, GX_ERROR_NOT_FINITE, "colliders.distance", pair->collider) : GX_OK;
}

/* Lists the pairs of a facet with a collider: at the corners of all parts, each with its share of the area. */
static gx_result gxp_seek_on_facet(gx_body *body, const gxp_touch_surface *s, double dt, double area,
                                   gxp_touch_pair *pair, gx_failure *failure) {
    const gxp_touch_facet *f = &s->facets[pair->sample - s->vertex_count];
    const uint32_t parts = pair->parts;
    uint32_t i, j, m;
    gx_result result = GX_OK;
    for (i = 0; i <= parts; i++)
        for (j = 0; i + j <= parts && result == GX_OK; j++) {
            const int rims = (i == 0) + (j == 0) + (i + j == parts);
            double x[6] = {0, 0, 0, 0, 0, 0};
            int n, wild = 0;
            pair->share[0] = (double)(parts - i - j) / parts;
            pair->share[1] = (double)i / parts;
            pair->share[2] = (double)j / parts;
            pair->area = area * (rims == 0 ? 6 : rims == 1 ? 3 : 1) / (3.0 * parts * parts);
            pair->rest[0] = pair->rest[1] = pair->rest[2] = 0;
            for (n = 0; n < 3; n++) {
                for (m = 0; m < 6; m++) x[m] += pair->share[n] * body->touch.moved[9 * (size_t)f->vertex[n] + m];
                for (m = 0; m < 3; m++) pair->rest[m] += pair->share[n] * s->vertices[f->vertex[n]].rest[m];
            }
            if (gxp_meets_collider(body, x, s->vertices[f->vertex[0]].size, dt, pair, &wild))
                result = gxp_list_pair(body, s, pair, failure);
            if (wild) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "colliders.distance", pair->collider);
        }
    return result;
}

/* Where a sample has pressed on a collider that has left, a pair without stiffness wakes what rested on it. first: of
   the sample's pairs */
static gx_result gxp_wake_left(gx_body *body, const gxp_touch_surface *s, uint32_t sample, uint32_t first,
                               gx_failure *failure) {
    gxp_touch *t = &body->touch;
    uint32_t i, j;
    gx_result result = GX_OK;
    for (i = gxp_first_state(s, sample); i < s->state_count && s->states[i].sample == sample && result == GX_OK; i++) {
        gxp_touch_pair lost = gxp_no_pair(sample);
        if (s->states[i].other == GXP_NONE || !gxp_has_changed(t, s->states[i].other)) continue;
        for (j = first; j < t->found && t->pairs[j].other != s->states[i].other;) j++;
        if (j < t->found) continue;
        lost.share[0] = lost.normal[0] = 1;
        lost.other = s->states[i].other; /* once */
        result = gxp_list_pair(body, s, &lost, failure);
    }
    return result;
}

/* Lists the pairs of a sample with colliders: those that touch.order has for it from *next on. */
static gx_result gxp_seek_colliders(gx_body *body, const gxp_touch_surface *s, double dt, uint32_t sample,
                                    uint32_t *next, gx_failure *failure) {
    gxp_touch *t = &body->touch;
    const uint32_t first = t->found;
    gx_result result = GX_OK;
    while (*next < t->order.count && GXP_FIRST(t->order.data[*next]) == sample && result == GX_OK) {
        gxp_touch_pair pair = gxp_no_pair(sample);
        double area = 0;
        pair.collider = t->beside[GXP_SECOND(t->order.data[*next])].collider;
        pair.parts = t->beside[GXP_SECOND(t->order.data[*next])].parts;
        for (; *next < t->order.count && GXP_FIRST(t->order.data[*next]) == sample &&
               t->beside[GXP_SECOND(t->order.data[*next])].collider == pair.collider;
             (*next)++)
            area += t->beside[GXP_SECOND(t->order.data[*next])].area;
        pair.area = area;
        if (!gxp_is_let(t, gxp_sample_vertex(s, sample)->fragment, GXP_NONE, t->colliders[pair.collider].id)) continue;
        result = sample < s->vertex_count ? gxp_seek_at_vertex(body, s, dt, &pair, failure)
                                          : gxp_seek_on_facet(body, s, dt, area, &pair, failure);
    }
    return result == GX_OK ? gxp_wake_left(body, s, sample, first, failure) : result;
}

/* Lists the pairs of all samples. */
static gx_result gxp_seek_pairs(gx_body *body, const gxp_touch_surface *s, double dt, gx_failure *failure) {
    gxp_touch *t = &body->touch;
    gx_result result = gxp_list_all_beside(body, s, dt, failure);
    uint32_t i, next = 0;
    const uint32_t state_end = s->state_count > 0 ? s->states[s->state_count - 1].sample + 1 : 0;
    t->found = 0;
    if (result == GX_OK) result = gxp_end(failure, gxp_seek_facets(body, s, dt));
    for (i = 0; i < s->vertex_count && result == GX_OK && s->facet_count > 0; i++) {
        gxp_touch_pair pair = gxp_no_pair(i);
        pair.facet = s->guesses.data[i];
        if (pair.facet != GXP_NONE) {
            (void)gxp_meets(body, s, dt, &pair); /* as it was found */
            result = gxp_list_pair(body, s, &pair, failure);
        }
        if (result == GX_OK && (t->order.count > 0 || i < state_end))
            result = gxp_seek_colliders(body, s, dt, i, &next, failure);
    }
    for (; i < s->vertex_count + s->facet_count && (next < t->order.count || i < state_end) && result == GX_OK; i++)
        result = gxp_seek_colliders(body, s, dt, i, &next, failure);
    return result;
}

/* >>pressing: what pairs do ---------------------------------------------------------------------------------------- */
/* In: the pairs of a step. Out: the same as the solver takes them; after the step, what samples press with, and what
   the caller learns of it. Touches what a step with contact works with. */

/* Room for what a step with that surface needs before it knows its pairs */
static gx_result gxp_surface_room(gx_body *body, const gxp_touch_surface *s) {
    const gx_allocator *a = &body->config.allocator;
    gxp_touch *t = &body->touch;
    gx_result result = gxp_reserve(a, &t->moved, 9 * sizeof(double), 0, &t->moved_capacity, s->vertex_count);
    for (t->leaf_count = 1; GXP_TOUCH_LEAF * (size_t)t->leaf_count < s->facet_count;) t->leaf_count *= 2;
    if (result == GX_OK)
        result = gxp_reserve(a, &t->facing, 3 * sizeof(double), 0, &t->facing_capacity, s->facet_count);
    return result == GX_OK ? gxp_reserve(a, &t->boxes, sizeof *t->boxes, 0, &t->box_capacity, 2 * t->leaf_count)
                           : result;
}

/* Adds a share of a copy's motion to a point. */
static void gxp_add_share(gxs_point *point, uint32_t *copies, double *weights, uint32_t copy, double weight) {
    uint32_t i;
    for (i = 0; i < point->count && copies[i] != copy;) i++;
    if (i == point->count) {
        copies[point->count] = copy;
        weights[point->count++] = 0;
    }
    weights[i] += weight;
}

/* Adds a share of a vertex to a point: of its place at rest and of what moves it, copies and their hidden vectors. */
static void gxp_add_place(const gx_body *body, const gxp_touch_vertex *v, double share, gxs_point *point,
                          uint32_t *copies, double *weights) {
    int k, j;
    for (k = 0; k < 3; k++) point->position[k] += share * v->rest[k];
    for (k = 0; k < 4 && v->weights[k] > 0; k++) {
        const double weight = share * v->weights[k], *x = body->mesh.positions;
        const uint32_t hidden = body->hidden.copies.count > 0 ? body->hidden.first.data[v->copies[k]] : GXS_NOT_AFFINE;
        gxp_add_share(point, copies, weights, v->copies[k], weight);
        x += 3 * (size_t)body->copies.node[v->copies[k]];
        for (j = 0; j < 3 && hidden != GXS_NOT_AFFINE; j++)
            gxp_add_share(point, copies, weights, hidden + (uint32_t)j,
                          weight * (v->rest[j] - x[j]) / body->mesh.affine_length);
    }
}

/* The point of a pair: its sample, relative to the place on the facet, or to that of the collider at the step's end.
   Returns 0 if nothing moves it. */
static int gxp_meeting_point(const gx_body *body, const gxp_touch_surface *s, const gxp_touch_pair *pair,
                             uint32_t *copies, double *weights, gxs_point *point) {
    double moves = 0;
    uint32_t m;
    int i, k;
    if (pair->sample < s->vertex_count)
        gxp_add_place(body, &s->vertices[pair->sample], 1, point, copies, weights);
    else
        for (i = 0; i < 3; i++)
            if (pair->share[i] > 0)
                gxp_add_place(body, &s->vertices[s->facets[pair->sample - s->vertex_count].vertex[i]], pair->share[i],
                              point, copies, weights);
    for (i = 0; i < 3 && pair->facet != GXP_NONE; i++)
        if (pair->share[i] > 0)
            gxp_add_place(body, &s->vertices[s->facets[pair->facet].vertex[i]], -pair->share[i], point, copies,
                          weights);
    for (k = 0; k < 3; k++) point->position[k] -= pair->place[k] + pair->way[k];
    for (m = 0; m < point->count; m++) moves += fabs(weights[m]);
    for (m = 0; m < point->count && !(moves > 1e-9); m++) weights[m] = 0; /* it was rounding */
    point->copies = copies;
    point->weights = weights;
    return moves > 1e-9;
}

/* Vectors of the point of a pair at most */
static size_t gxp_pair_span(const gx_body *body) {
    return GXP_TOUCH_COPIES * (body->hidden.copies.count > 0 ? 4u : 1u);
}

/* A pair as the solver takes it. It begins with the force with which the sample pressed before. */
static void gxp_set_pair(gx_body *body, const gxp_touch_surface *s, uint32_t i, double dt, gxs_pair *to) {
    const gxp_touch *t = &body->touch;
    const gxp_touch_pair *pair = &t->pairs[i];
    const gxp_touch_vertex *v = gxp_sample_vertex(s, pair->sample);
    const double recovery = t->desc.recovery > 0 ? t->desc.recovery : 2 * v->size;
    memset(to, 0, sizeof *to);
    to->point.epoch = body->cuts.epoch;
    memcpy(to->normal, pair->normal, sizeof to->normal);
    to->friction = t->desc.friction;
    to->sticking_speed = t->desc.sticking_speed;
    if (pair->facet != GXP_NONE) { /* the other side has a sample of its own somewhere near: each has half */
        const gxp_touch_vertex *w = &s->vertices[s->facets[pair->facet].vertex[0]];
        to->stiffness = 0.5 * t->desc.stiffness * fmin(v->young, w->young) * v->area / v->size;
    } else {
        to->flags = GXS_PAIR_OUTSIDE;
        if (pair->collider != GXP_NONE) {
            to->stiffness = t->desc.stiffness * v->young * pair->area / v->size;
            to->friction = t->colliders[pair->collider].friction;
        }
        if (pair->collider == GXP_NONE || t->changed.data[pair->collider]) to->flags |= GXS_PAIR_WAKES;
        memcpy(to->way, pair->way, sizeof to->way);
    }
    if (!gxp_meeting_point(body, s, pair, t->sides.data + gxp_pair_span(body) * i, t->weights + gxp_pair_span(body) * i,
                           &to->point))
        to->stiffness = 0;
    to->offset = fmin(0, fmin(0, pair->gap + pair->pressed) + dt * (recovery + fmax(0, pair->approach)));
    memcpy(t->slips + 3 * (t->given + (size_t)i), pair->slip, sizeof pair->slip);
}

/* Puts the pairs of contact behind the caller's. */
static gx_result gxp_join_pairs(gx_body *body, gxp_touch_surface *s, double dt, gxs_step_desc *step) {
    const gx_allocator *a = &body->config.allocator;
    gxp_touch *t = &body->touch;
    gxp_attached *attached = &body->attached;
    const size_t given = step->pair_count, all = given + t->found;
    const size_t copies = gxp_pair_span(body) * t->found;
    const int own = given > 0 && step->pairs != attached->pairs;
    gx_result result = all > INT32_MAX ? GX_ERROR_LIMIT : GX_OK;
    uint32_t i;
    if (result == GX_OK)
        result = gxp_reserve(a, &attached->pairs, sizeof *attached->pairs, own ? 0 : given, &attached->pair_capacity,
                             own ? all : t->found);
    t->sides.count = 0;
    if (result == GX_OK) result = gxp_words_room(body, &t->sides, copies);
    if (result == GX_OK) result = gxp_reserve(a, &t->weights, sizeof(double), 0, &t->weight_capacity, copies);
    if (result == GX_OK) result = gxp_reserve(a, &t->slips, 3 * sizeof(double), 0, &t->slip_capacity, all);
    if (result == GX_OK) result = gxp_reserve(a, &t->forces, 3 * sizeof(double), 0, &t->force_capacity, all);
    if (result == GX_OK)
        result = gxp_reserve(a, &s->states, sizeof *s->states, s->state_count, &s->state_capacity,
                             t->found > s->state_count ? t->found - s->state_count : 0);
    if (result != GX_OK) return result;
    t->given = (uint32_t)given;
    if (own) memcpy(attached->pairs, step->pairs, given * sizeof *attached->pairs);
    if (given > 0) memset(t->slips, 0, 3 * given * sizeof *t->slips);
    if (given > 0 && step->pair_slips != NULL) memcpy(t->slips, step->pair_slips, 3 * given * sizeof *t->slips);
    for (i = 0; i < t->found; i++) gxp_set_pair(body, s, i, dt, &attached->pairs[given + i]);
    step->pairs = attached->pairs;
    step->pair_count = all;
    step->pair_slips = t->slips;
    step->pair_forces = t->forces;
    return GX_OK;
}

/* Adds the pairs of contact to a step. surface: receives the one that they are of */
static gx_result gxp_attach_contact(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step,
                                    gxp_touch_surface **surface, gx_failure *failure) {
    const double dt = gxp_is_finite(step->dt) && step->dt > 0 ? step->dt : 0;
    gx_result result;
    body->touch.kept = 0;
    if (step->quality > 0) return gxp_refuse(failure, "quality"); /* its parts would not search again */
    if (step->integrator == GXS_MIDPOINT) return gxp_refuse(failure, "integrator");
    if (step->pair_count > 0 && step->pairs == NULL) return gxp_refuse(failure, "pairs");
    result = gxp_take_colliders(body, desc, failure);
    if (result != GX_OK) return result;
    result = gxp_step_surface(body, surface);
    if (result == GX_OK) result = gxp_surface_room(body, *surface);
    if (gxp_end(failure, result) != GX_OK) return result;
    gxp_move_surface(body, *surface);
    gxp_fit_facets(body, *surface, dt);
    result = gxp_seek_pairs(body, *surface, dt, failure);
    return result == GX_OK ? gxp_end(failure, gxp_join_pairs(body, *surface, dt, step)) : result;
}

/* A number of a vector of the solver's model: of a copy's displacement, or of a hidden vector */
static double gxp_vector_at(const gx_body *body, uint32_t vector, int axis) {
    const uint32_t part = vector - body->copies.count;
    if (vector < body->copies.count) return body->copies.displacement[3 * (size_t)vector + (size_t)axis];
    return body->mesh.affine_length *
           body->copies.linear[9 * (size_t)body->hidden.copies.data[part / 3] + 3 * (part % 3) + (uint32_t)axis];
}

/* Where a pair's sample is now, relative to its other side */
static void gxp_pair_now(const gx_body *body, const gxs_pair *pair, double r[3]) {
    uint32_t i;
    int k;
    memcpy(r, pair->point.position, 3 * sizeof *r);
    for (i = 0; i < pair->point.count; i++)
        for (k = 0; k < 3; k++) r[k] += pair->point.weights[i] * gxp_vector_at(body, pair->point.copies[i], k);
}

/* The stiffness of a pair's hold on the collider: of its depth and, while it sticks, of its slip. 00 01 02 11 12 22 */
static void gxp_hold_stiffness(const gxs_pair *pair, const gxp_touch_pair *own, double dt, const double slip[3],
                               double hold[6]) {
    const double elastic = pair->friction * fmax(0, pair->offset - own->gap_before);
    const double reach = fmax(elastic, dt * (pair->sticking_speed > 0 ? pair->sticking_speed : 1e-3));
    const double along =
        reach > 0 && sqrt(gxp_dot(slip, slip)) < (1 - 1e-9) * reach ? pair->stiffness * elastic / reach : 0;
    const double across = own->pressed > 0 ? pair->stiffness : 0;
    int i, j, at = 0;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++)
            hold[at++] = (i == j ? along : 0) + (across - along) * pair->normal[i] * pair->normal[j];
}

/* Adds what a pair does to its collider. arm: from the collider's o to the sample */
static void gxp_add_load(const double force[3], const double hold[6], const double arm[3], gx_collider_load *load) {
    static const int packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const double turn[3][3] = {{0, arm[2], -arm[1]}, {-arm[2], 0, arm[0]}, {arm[1], -arm[0], 0}}; /* of the sample */
    double torque[3], jacobian[3][6], moved[3][6];
    int i, j, k;
    gxp_cross(torque, arm, force);
    for (k = 0; k < 3; k++) {
        load->force[k] -= force[k];
        load->torque[k] -= torque[k];
        for (j = 0; j < 3; j++) {
            jacobian[k][j] = k == j;
            jacobian[k][3 + j] = turn[k][j];
        }
    }
    for (k = 0; k < 3; k++)
        for (j = 0; j < 6; j++)
            moved[k][j] = hold[packed[k][0]] * jacobian[0][j] + hold[packed[k][1]] * jacobian[1][j] +
                          hold[packed[k][2]] * jacobian[2][j];
    for (i = 0; i < 6; i++)
        for (j = 0; j < 6; j++)
            load->stiffness[6 * i + j] +=
                jacobian[0][i] * moved[0][j] + jacobian[1][i] * moved[1][j] + jacobian[2][i] * moved[2][j];
    load->contacts++;
}

/* What colliders feel at the end of a step */
static void gxp_report_loads(const gx_body *body, const gx_step_desc *desc) {
    const gxp_touch *t = &body->touch;
    uint32_t i;
    if (desc->collider_loads == NULL || desc->collider_count == 0) return;
    memset(desc->collider_loads, 0, desc->collider_count * sizeof *desc->collider_loads);
    for (i = 0; i < t->found; i++) {
        const gxp_touch_pair *pair = &t->pairs[i];
        const gxs_pair *solved = &body->attached.pairs[t->given + i];
        const double *force = t->forces + 3 * ((size_t)t->given + i);
        double r[3], arm[3], hold[6];
        int k;
        if (pair->collider == GXP_NONE || !(gxp_dot(force, force) > 0)) continue;
        gxp_pair_now(body, solved, r);
        for (k = 0; k < 3; k++)
            arm[k] = r[k] + pair->place[k] + pair->way[k] - t->colliders[pair->collider].pose[4 * k + 3] -
                     desc->dt * t->colliders[pair->collider].velocity[k];
        gxp_hold_stiffness(solved, pair, desc->dt, t->slips + 3 * ((size_t)t->given + i), hold);
        gxp_add_load(force, hold, arm, &desc->collider_loads[pair->collider]);
    }
}

/* Hash of what samples press with; 0: nothing does */
static uint64_t gxp_hash_states(const gxp_touch_surface *s) {
    uint64_t hash = 1;
    uint32_t i;
    for (i = 0; i < s->state_count; i++) {
        hash = gxp_hash_words(hash, &s->states[i].sample, 1);
        hash = gxp_hash_words(hash, &s->states[i].other, 1);
        hash = gxp_hash_doubles(gxp_hash_doubles(hash, &s->states[i].pressed, 1), s->states[i].slip, 3);
    }
    return s->state_count > 0 ? hash | 1 : 0;
}

/* After a step: the caller's pairs get their slips and forces, samples what they press with. */
static void gxp_keep_contact(gx_body *body, const gx_step_desc *desc, gxp_touch_surface *surface) {
    gxp_touch *t = &body->touch;
    uint32_t i;
    if (t->given > 0 && desc->pair_slips != NULL)
        memcpy(desc->pair_slips, t->slips, 3 * (size_t)t->given * sizeof(double));
    if (t->given > 0 && desc->pair_forces != NULL)
        memcpy(desc->pair_forces, t->forces, 3 * (size_t)t->given * sizeof(double));
    surface->state_count = 0;
    for (i = 0; i < t->found; i++) {
        const gxs_pair *solved = &body->attached.pairs[t->given + i];
        gxp_touch_pair *pair = &t->pairs[i];
        gxp_touch_state state;
        double r[3];
        gxp_pair_now(body, solved, r);
        pair->gap_before = pair->gap;
        pair->gap = gxp_dot(r, solved->normal);
        pair->pressed = solved->stiffness > 0 ? fmax(0, solved->offset - pair->gap) : 0;
        memcpy(pair->slip, t->slips + 3 * ((size_t)t->given + i), sizeof pair->slip);
        if (!(pair->pressed > 0) && !(gxp_dot(pair->slip, pair->slip) > 0)) continue;
        state.sample = pair->sample;
        state.other = pair->other;
        state.pressed = pair->pressed;
        memcpy(state.slip, pair->slip, sizeof state.slip);
        memcpy(state.rest, pair->rest, sizeof state.rest);
        surface->states[surface->state_count++] = state;
    }
    t->pressed = gxp_hash_states(surface);
    gxp_report_loads(body, desc);
    gxp_know_colliders(t);
    t->current = surface == &t->surfaces[0] ? 0 : 1;
    t->made = 1;
    t->hash = body->cuts.hash;
    t->kept = t->found;
}

/* Forgets the surface and its state, not that contact is on. */
static void gxp_forget_contact(gx_body *body) {
    body->touch.made = 0;
    body->touch.known_count = body->touch.touching.count = 0;
    body->touch.pressed = 0;
}

GXFEM_API gx_result gx_body_contact(gx_body *body, const gx_contact_desc *desc, gx_failure *failure) {
    static const char *const names[5] = {"stiffness", "friction", "sticking_speed", "recovery", "depth"};
    gx_contact_desc own;
    double numbers[5];
    int i;
    if (body == NULL) return gxp_refuse(failure, "body");
    memset(&own, 0, sizeof own);
    if (desc != NULL) own = *desc;
    numbers[0] = own.stiffness;
    numbers[1] = own.friction;
    numbers[2] = own.sticking_speed;
    numbers[3] = own.recovery;
    numbers[4] = own.depth;
    for (i = 0; i < 5; i++) {
        if (!gxp_is_finite(numbers[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, names[i], SIZE_MAX);
        if (numbers[i] < 0) return gxp_refuse(failure, names[i]);
    }
    if (!(own.stiffness > 0)) own.stiffness = 10;
    if (!(own.depth > 0)) own.depth = 0.5;
    body->touch.desc = own;
    body->touch.on = desc != NULL;
    gxp_forget_contact(body);
    return gxp_end(failure, GX_OK);
}

/* Where the sample of a pair is in space */
static void gxp_place_sample(const gx_body *body, const gxp_touch_surface *s, const gxp_touch_pair *pair, double x[3]) {
    const int facet = pair->sample >= s->vertex_count;
    int i, k;
    x[0] = x[1] = x[2] = 0;
    for (i = 0; i < (facet ? 3 : 1); i++) {
        const gxp_touch_vertex *v =
            &s->vertices[facet ? s->facets[pair->sample - s->vertex_count].vertex[i] : pair->sample];
        double own[3];
        gxp_map_point(body, v->rest, v->copies, v->weights, 4, own);
        for (k = 0; k < 3; k++) x[k] += (facet ? pair->share[i] : 1) * own[k];
    }
}

GXFEM_API gx_result gx_body_contacts(const gx_body *body, gx_contact *contacts, size_t capacity, size_t *count,
                                     gx_failure *failure) {
    const gxp_touch *t;
    const gxp_touch_surface *s;
    size_t all = 0;
    uint32_t i;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (count == NULL) return gxp_refuse(failure, "count");
    if (contacts == NULL && capacity > 0) return gxp_refuse(failure, "contacts");
    *count = 0;
    t = &body->touch;
    s = &t->surfaces[t->current];
    if (!t->on || (t->made && t->hash != body->cuts.hash))
        return gxp_fail(failure, GX_ERROR_SEQUENCE, t->on ? "gx_body_step" : "gx_body_contact", SIZE_MAX);
    for (i = 0; i < t->kept && t->made; i++) {
        const gxp_touch_pair *pair = &t->pairs[i];
        if (!(pair->pressed > 0)) continue;
        if (all < capacity) {
            gx_contact *c = &contacts[all];
            c->fragment = gxp_sample_vertex(s, pair->sample)->fragment;
            c->other = pair->facet != GXP_NONE ? s->facets[pair->facet].fragment : GXP_NONE;
            c->collider = pair->other;
            gxp_place_sample(body, s, pair, c->position);
            memcpy(c->normal, pair->normal, sizeof c->normal);
            memcpy(c->force, t->forces + 3 * ((size_t)t->given + i), sizeof c->force);
            c->depth = -pair->gap;
        }
        all++;
    }
    *count = all;
    return all > capacity ? gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX) : gxp_end(failure, GX_OK);
}

/* >>telling: what touches, for the caller -------------------------------------------------------------------------- */
/* In: the pairs of the last step, what touched at the caller's last question. Out: events by fragments. Touches what is
   known of the last question. */

/* The event of a pair, without what touched before */
static void gxp_describe_pair(const gx_body *body, const gxp_touch_surface *s, uint32_t i, gxp_touch_event *event) {
    const gxp_touch_pair *pair = &body->touch.pairs[i];
    const double *force = body->touch.forces + 3 * ((size_t)body->touch.given + i);
    const uint32_t own = body->snapshot.id[gxp_sample_vertex(s, pair->sample)->fragment];
    const uint32_t other = pair->facet != GXP_NONE ? body->snapshot.id[s->facets[pair->facet].fragment] : 0;
    const double load = fmax(0, gxp_dot(force, pair->normal)), side = other != 0 && other < own ? -1 : 1;
    double x[3];
    int k;
    memset(event, 0, sizeof *event);
    event->who[0] = side < 0 ? other : own;
    event->who[1] = side < 0 ? own : other;
    event->who[2] = pair->other;
    event->contacts = 1;
    event->load = load;
    gxp_place_sample(body, s, pair, x);
    for (k = 0; k < 3; k++) {
        event->force[k] = own == other ? 0 : side * force[k];
        event->position[k] = load * x[k];
        event->normal[k] = side * load * pair->normal[k];
    }
}

/* Below 0, 0, above 0: the order of two events */
static int gxp_compare_touching(const uint32_t *a, const uint32_t *b) {
    int k;
    for (k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Lists what touches now: touch.events, ascending, one for each two. Pairs are in order of their sample, so that those
   of two pieces are often neighbours. */
static gx_result gxp_list_touching(gx_body *body, uint32_t *count) {
    gxp_touch *t = &body->touch;
    const gxp_touch_surface *s = &t->surfaces[t->current];
    uint32_t i, at;
    int k;
    *count = 0;
    for (i = 0; i < t->kept && t->made; i++) {
        gxp_touch_event one;
        uint32_t low = 0, high = *count;
        gx_result result;
        if (!(t->pairs[i].pressed > 0)) continue;
        gxp_describe_pair(body, s, i, &one);
        while (low < high) {
            const uint32_t middle = low + (high - low) / 2;
            if (gxp_compare_touching(t->events[middle].who, one.who) < 0)
                low = middle + 1;
            else
                high = middle;
        }
        at = low;
        if (at < *count && gxp_compare_touching(t->events[at].who, one.who) == 0) {
            t->events[at].contacts++;
            t->events[at].load += one.load;
            for (k = 0; k < 3; k++) {
                t->events[at].force[k] += one.force[k];
                t->events[at].position[k] += one.position[k];
                t->events[at].normal[k] += one.normal[k];
            }
            continue;
        }
        result = gxp_reserve(&body->config.allocator, &t->events, sizeof *t->events, *count, &t->event_capacity, 1);
        if (result != GX_OK) return result;
        memmove(t->events + at + 1, t->events + at, (*count - at) * sizeof *t->events);
        t->events[at] = one;
        (*count)++;
    }
    return GX_OK;
}

/* An event as the caller takes it. was: it touched at the last call; now NULL: it does not any more */
static void gxp_tell_event(const gxp_touch_event *now, const uint32_t *was, gx_contact_event *to) {
    int k;
    memset(to, 0, sizeof *to);
    to->change = now == NULL ? GX_CONTACT_ENDED : was != NULL ? GX_CONTACT_PERSISTS : GX_CONTACT_BEGAN;
    if (now != NULL) was = now->who;
    to->fragment = was[0];
    to->other = was[1];
    to->collider = was[2];
    if (now == NULL) return;
    to->contacts = now->contacts;
    to->load = now->load;
    memcpy(to->force, now->force, sizeof to->force);
    for (k = 0; k < 3; k++) to->position[k] = now->load > 0 ? now->position[k] / now->load : 0;
    (void)gxp_unit(now->normal, to->normal);
}

GXFEM_API gx_result gx_body_contact_events(gx_body *body, gx_contact_event *events, size_t capacity, size_t *count,
                                           gx_failure *failure) {
    gxp_touch *t;
    size_t all = 0;
    uint32_t now, i = 0, j = 0;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (count == NULL) return gxp_refuse(failure, "count");
    if (events == NULL && capacity > 0) return gxp_refuse(failure, "events");
    *count = 0;
    t = &body->touch;
    if (!t->on || (t->made && t->hash != body->cuts.hash))
        return gxp_fail(failure, GX_ERROR_SEQUENCE, t->on ? "gx_body_step" : "gx_body_contact", SIZE_MAX);
    if (body->snapshot.stale) return gxp_fail(failure, GX_ERROR_SEQUENCE, "gx_body_view", SIZE_MAX);
    result = gxp_list_touching(body, &now);
    if (result == GX_OK)
        result = gxp_words_room(body, &t->touching, 3 * now > t->touching.count ? 3 * now - t->touching.count : 0);
    if (gxp_end(failure, result) != GX_OK) return result;
    while (i < now || 3 * j < t->touching.count) {
        const uint32_t *was = 3 * j < t->touching.count ? t->touching.data + 3 * (size_t)j : NULL;
        const int order = i == now ? 1 : was == NULL ? -1 : gxp_compare_touching(t->events[i].who, was);
        if (all < capacity) gxp_tell_event(order <= 0 ? &t->events[i] : NULL, order >= 0 ? was : NULL, &events[all]);
        all++;
        i += order <= 0;
        j += order >= 0;
    }
    *count = all;
    if (all > capacity) return gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    for (i = 0; i < now; i++) memcpy(t->touching.data + 3 * (size_t)i, t->events[i].who, 3 * sizeof(uint32_t));
    t->touching.count = 3 * now;
    return GX_OK;
}

/* >>step: time steps ----------------------------------------------------------------------------------------------- */
/* In: a step's description. Out: displacement and velocity at its end, or the body as it was. Touches the state of
   copies, the history that BDF2 needs, and the solver. */

/* Makes the first `count` columns of BDF2's history, unless they are there. */
static gx_result gxp_start_history(gx_body *body, uint32_t count) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < count && result == GX_OK; i++)
        if (body->copies.history[i] == NULL)
            result = gxp_grow_column(body, &gxp_copy_columns[GXP_FIRST_HISTORY + i], 0, body->copies.count);
    return result;
}

/* What acts on the body, as the solver takes it */
static void gxp_translate_loads(const gx_step_desc *desc, gxs_step_desc *step) {
    memcpy(step->gravity, desc->gravity, sizeof step->gravity);
    step->mass_damping = desc->mass_damping;
    step->forces = desc->forces;
    step->targets = desc->targets;
    step->epoch = desc->epoch;
    step->springs = desc->springs;
    step->spring_count = desc->spring_count;
    step->spring_forces = desc->spring_forces;
    step->points = desc->points;
    step->point_count = desc->point_count;
    step->planes = desc->planes;
    step->plane_count = desc->plane_count;
    step->contact = desc->contact;
    step->contact_user = desc->contact_user;
    step->pairs = desc->pairs;
    step->pair_count = desc->pair_count;
    step->pair_slips = desc->pair_slips;
    step->pair_forces = desc->pair_forces;
}

/* The step as the solver takes it: the only place where one description becomes the other. The body adds its rest
   times, its history and, where the description has none, its clock. */
static gx_result gxp_translate_step(gx_body *body, const gx_step_desc *desc, gxs_step_desc *step) {
    const int history = desc->integrator == GXS_BDF2 && !(desc->quality > 0), own_clock = desc->clock == NULL;
    memset(step, 0, sizeof *step);
    gxp_translate_loads(desc, step);
    step->dt = desc->dt;
    step->integrator = desc->integrator;
    step->substeps = desc->substeps;
    step->quick = desc->quick;
    step->newton_iterations = desc->newton_iterations;
    step->newton_tolerance = desc->newton_tolerance;
    step->cg_iterations = desc->cg_iterations;
    step->cg_tolerance = desc->cg_tolerance;
    step->sleep_speed = desc->sleep_speed;
    step->sleep_time = desc->sleep_time;
    step->budget_seconds = desc->budget_seconds;
    step->quality = desc->quality;
    step->clock = own_clock ? body->config.clock : desc->clock;
    step->clock_user = own_clock ? body->config.clock_user : desc->clock_user;
    step->rest_times = body->copies.rest_time;
    if (history) {
        const gx_result result = gxp_start_history(body, 4);
        if (result != GX_OK) return result;
    }
    step->previous_displacement = history && body->copies.previous_dt > 0 ? body->copies.history[0] : NULL;
    step->previous_velocity = body->copies.history[1];
    step->previous_dt = body->copies.previous_dt;
    return GX_OK;
}

/* The hidden vectors of the model's affine copies: A times affine_length */
static void gxp_hide(const gx_body *body, const double *linear, double *vectors) {
    size_t i, k;
    for (i = 0; i < body->hidden.copies.count; i++)
        for (k = 0; k < 9; k++)
            vectors[9 * i + k] = body->mesh.affine_length * linear[9 * (size_t)body->hidden.copies.data[i] + k];
}

static void gxp_unhide(const gx_body *body, const double *vectors, double *linear) {
    size_t i, k;
    for (i = 0; i < body->hidden.copies.count; i++)
        for (k = 0; k < 9; k++)
            linear[9 * (size_t)body->hidden.copies.data[i] + k] = vectors[9 * i + k] / body->mesh.affine_length;
}

/* A step of a model with hidden vectors: in vectors of their own, which become the state if it succeeds. What is left
   of the motion of copies that are affine, but not in the model, is dropped: a speck moves as a point. */
static gx_result gxp_step_affine(gx_body *body, const gxs_step_desc *given, gx_step_report *report,
                                 gx_failure *failure) {
    gxp_copies *copies = &body->copies;
    const size_t n = copies->count, vectors = gxp_vector_count(body), bytes = 3 * n * sizeof(double);
    const int history = given->previous_displacement != NULL;
    gxs_step_desc step = *given;
    gx_failure own;
    double *u, *v, *before, *rest;
    size_t i, k;
    gx_result result = vectors > INT32_MAX / 16
                         ? GX_ERROR_LIMIT
                         : gxp_reserve(&body->config.allocator, &body->hidden.state, sizeof(double), 0,
                                       &body->hidden.state_capacity, 13 * vectors);
    if (result != GX_OK) return gxp_end(failure, result);
    u = body->hidden.state;
    v = u + 3 * vectors;
    before = v + 3 * vectors;
    rest = before + 6 * vectors;
    memcpy(u, copies->displacement, bytes);
    memcpy(v, copies->velocity, bytes);
    memcpy(rest, copies->rest_time, n * sizeof *rest);
    gxp_hide(body, copies->linear, u + 3 * n);
    gxp_hide(body, copies->linear_rate, v + 3 * n);
    for (i = n; i < vectors; i++) rest[i] = rest[body->hidden.copies.data[(i - n) / 3]];
    if (history) {
        memcpy(before, copies->history[0], bytes);
        memcpy(before + 3 * vectors, copies->history[1], bytes);
        gxp_hide(body, copies->linear_history[0], before + 3 * n);
        gxp_hide(body, copies->linear_history[1], before + 3 * vectors + 3 * n);
        step.previous_displacement = before;
        step.previous_velocity = before + 3 * vectors;
    }
    step.rest_times = rest;
    gxp_end(&own, GX_OK);
    result = gxs_solver_step(body->solver, &step, u, v, report, &own);
    memcpy(copies->rest_time, rest, n * sizeof *rest);
    if (result != GX_OK) {
        if (own.field != NULL && own.index >= n &&
            (strcmp(own.field, "displacement") == 0 || strcmp(own.field, "velocity") == 0))
            own.index = body->hidden.copies.data[(own.index - n) / 3];
        if (failure != NULL) *failure = own;
        return result;
    }
    if (given->integrator == GXS_BDF2 && !(given->quality > 0)) {
        memcpy(copies->linear_history[0], copies->linear, 9 * n * sizeof(double));
        memcpy(copies->linear_history[1], copies->linear_rate, 9 * n * sizeof(double));
    }
    memcpy(copies->displacement, u, bytes);
    memcpy(copies->velocity, v, bytes);
    gxp_unhide(body, u + 3 * n, copies->linear);
    gxp_unhide(body, v + 3 * n, copies->linear_rate);
    for (i = 0; i < n; i++)
        for (k = 0; k < 9 && body->hidden.first.data[i] == GXS_NOT_AFFINE; k++) copies->linear_rate[9 * i + k] = 0;
    return GX_OK;
}

/* Takes the step and keeps the state that the next step of BDF2 needs. */
static gx_result gxp_step(gx_body *body, const gxs_step_desc *step, gx_step_report *report, gx_failure *failure) {
    gxp_copies *copies = &body->copies;
    const size_t bytes = 3 * (size_t)copies->count * sizeof(double);
    const int history = step->integrator == GXS_BDF2 && !(step->quality > 0);
    const gxp_column *columns = gxp_copy_columns + GXP_FIRST_HISTORY;
    gx_result result;
    int i;
    if (history) {
        memcpy(copies->history[2], copies->displacement, bytes);
        memcpy(copies->history[3], copies->velocity, bytes);
    }
    if (body->hidden.copies.count > 0)
        result = gxp_step_affine(body, step, report, failure);
    else {
        result = gxs_solver_step(body->solver, step, copies->displacement, copies->velocity, report, failure);
        if (result == GX_OK && copies->bends) memset(copies->linear_rate, 0, 9 * copies->count * sizeof(double));
    }
    if (result != GX_OK) return result;
    copies->previous_dt = history ? step->dt : 0;
    for (i = 0; i < 2 && history; i++) gxp_swap_columns(body, &columns[i], &columns[i + 2]);
    return GX_OK;
}

/* A step of a body of which nothing is left. Lost anchors name copy 0, which is not there. */
static gx_result gxp_check_empty_step(const gx_body *body, const gx_step_desc *desc, const gxs_step_desc *step,
                                      gx_failure *failure) {
    const uint32_t named = desc->spring_anchors != NULL || desc->point_anchors != NULL || desc->pair_anchors != NULL;
    const gx_result result = gxs_step_check(step, body->copies.count + named, body->cuts.epoch, failure);
    size_t i;
    for (i = 0; i < 3 * step->spring_count && step->spring_forces != NULL && result == GX_OK; i++)
        step->spring_forces[i] = 0;
    for (i = 0; i < 3 * step->pair_count && step->pair_forces != NULL && result == GX_OK; i++) step->pair_forces[i] = 0;
    return result;
}

GXFEM_API gx_result gx_body_step(gx_body *body, const gx_step_desc *desc, gx_step_report *report, gx_failure *failure) {
    const double start = body != NULL ? gxp_seconds(body) : 0;
    gxs_step_desc step;
    gxp_touch_surface *surface = NULL;
    gx_failure refused;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (desc == NULL) return gxp_refuse(failure, "desc");
    if (desc->collider_count > 0 && !body->touch.on)
        return gxp_fail(failure, GX_ERROR_SEQUENCE, "gx_body_contact", SIZE_MAX);
    gxp_wake_resumed(body, body->copies.count);
    gxp_end(&refused, GX_OK);
    result = gxp_update_model(body, &refused);
    if (result != GX_OK) return gxp_fail(failure, result, NULL, refused.index);
    result = gxp_translate_step(body, desc, &step);
    if (gxp_end(failure, result) == GX_OK) result = gxp_attach(body, desc, &step, failure);
    if (result == GX_OK && body->touch.on) result = gxp_attach_contact(body, desc, &step, &surface, failure);
    if (result == GX_OK && body->hidden.copies.count > 0) result = gxp_end(failure, gxp_expand(body, desc, &step));
    if (result != GX_OK) return result;
    if (body->model.empty) {
        result = gxp_check_empty_step(body, desc, &step, failure);
        if (result == GX_OK && surface != NULL) gxp_keep_contact(body, desc, surface);
        if (result == GX_OK && report != NULL) {
            memset(report, 0, sizeof *report);
            report->stop = GXS_STOP_ASLEEP;
        }
        return result;
    }
    result = gxp_step(body, &step, report, failure);
    if (result == GX_OK && surface != NULL) gxp_keep_contact(body, desc, surface);
    if (result == GX_OK) body->model.resumed = 0;
    if (result == GX_OK && report != NULL) report->seconds = gxp_seconds(body) - start;
    return result;
}

/* >>layers: the cells around a blade, and how they hang together --------------------------------------------------- */
/* In: the strip between the fronts of a blade and its edge. Out: the cells within an element's size of it, with their
   deformed corners, and the layer to which each belongs: cells that hang together there through copies. Pieces that lie
   over each other in space are different layers. Touches the blade's working memory. */

/* The cell of an element at a material point, GXP_NONE where it was removed */
static gx_result gxp_cell_at(gx_body *body, uint32_t element, const double rest[3], uint32_t *cell) {
    uint32_t leaf = GXP_NONE;
    const gx_result result = gxp_leaf_at(body, element, rest, NULL, &leaf);
    *cell = GXP_NONE;
    if (result == GX_OK && gxp_is_kept(body, leaf)) *cell = body->leaves.data[leaf].cell;
    return result;
}

/* The point of a segment nearest to p: *share of the way from a to b. Returns the squared distance. */
static double gxp_onto_segment(const double *p, const double *a, const double *b, double *share, double nearest[3]) {
    double along = 0, length = 0, t;
    int k;
    for (k = 0; k < 3; k++) {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    t = length > 0 ? along / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (k = 0; k < 3; k++) nearest[k] = a[k] + t * (b[k] - a[k]);
    *share = t;
    return gxp_square_distance(p, nearest);
}

/* The point of a triangle nearest to p. Returns the squared distance. */
static double gxp_onto_triangle(const double *p, const double *a, const double *b, const double *c, double nearest[3]) {
    const double *corner[4] = {a, b, c, a};
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]},
                 w[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    double n[3], x[3], y[3], square, best, share, at[3];
    int k;
    gxp_cross(n, u, v);
    gxp_cross(x, w, v);
    gxp_cross(y, u, w);
    square = gxp_dot(n, n);
    if (square > 0 && gxp_dot(x, n) >= 0 && gxp_dot(y, n) >= 0 && gxp_dot(x, n) + gxp_dot(y, n) <= square) {
        const double height = gxp_dot(w, n) / square;
        for (k = 0; k < 3; k++) nearest[k] = p[k] - height * n[k];
        return height * height * square;
    }
    best = gxp_onto_segment(p, a, b, &share, nearest);
    for (k = 1; k < 3; k++) {
        square = gxp_onto_segment(p, corner[k], corner[k + 1], &share, at);
        if (square < best) {
            best = square;
            memcpy(nearest, at, sizeof at);
        }
    }
    return best;
}

/* Weights of a point by the corners of a tetrahedron, 1 in sum. Returns six times its volume. */
static double gxp_tet_weights(double corners[4][3], const double p[3], double weights[4]) {
    double e[3][3], n[3][3], d[3], volume;
    int i, k;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) e[i][k] = corners[i + 1][k] - corners[0][k];
    for (k = 0; k < 3; k++) d[k] = p[k] - corners[0][k];
    for (i = 0; i < 3; i++) gxp_cross(n[i], e[(i + 1) % 3], e[(i + 2) % 3]);
    volume = gxp_dot(e[0], n[0]);
    weights[0] = 1;
    for (i = 0; i < 3; i++) {
        weights[i + 1] = gxp_dot(n[i], d) / volume;
        weights[0] -= weights[i + 1];
    }
    return volume;
}

/* The point of those weights */
static void gxp_weigh(double corners[4][3], const double weights[4], double p[3]) {
    int i, k;
    for (k = 0; k < 3; k++) {
        p[k] = 0;
        for (i = 0; i < 4; i++) p[k] += weights[i] * corners[i][k];
    }
}

/* Where a cell's map has a place, also outside of its element */
static void gxp_image_by(const gx_body *body, const gxp_cell *cell, const double weights[4], double x[3]) {
    static const double origin[3] = {0, 0, 0};
    double corners[4][3];
    if (gxp_is_bent(body, cell)) {
        gxp_image_of_bent(body, cell, weights, x);
        return;
    }
    gxp_cell_corners(body, cell, 1, origin, corners);
    gxp_weigh(corners, weights, x);
}

/* The place that a cell's map has at a point of space, also outside of its element; not a number: the cell is flat */
static void gxp_place_by_map(const gx_body *body, const gxp_cell *cell, const double x[3], double weights[4]) {
    static const double origin[3] = {0, 0, 0};
    double corners[4][3];
    if (gxp_is_bent(body, cell) && gxp_place_in_bent(body, cell, x, weights)) return;
    gxp_cell_corners(body, cell, 1, origin, corners);
    gxp_tet_weights(corners, x, weights);
}

static gx_result gxp_push_vertex(gx_body *body, gxp_front_list *list, const gxp_front_vertex *vertex) {
    const gx_result result =
        gxp_reserve(&body->config.allocator, &list->data, sizeof *list->data, list->count, &list->capacity, 1);
    if (result == GX_OK) list->data[list->count++] = *vertex;
    return result;
}

static gx_result gxp_push_point(gx_body *body, gxp_points *list, const double x[3]) {
    const gx_result result =
        gxp_reserve(&body->config.allocator, &list->data, 3 * sizeof *list->data, list->count, &list->capacity, 1);
    if (result == GX_OK) memcpy(list->data + 3 * (size_t)list->count++, x, 3 * sizeof *x);
    return result;
}

static gx_result gxp_append_front(gx_body *body, gxp_front_list *to, const gxp_front_vertex *from, uint32_t count) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < count && result == GX_OK; i++) result = gxp_push_vertex(body, to, &from[i]);
    return result;
}

static gx_result gxp_copy_front(gx_body *body, gxp_front_list *to, const gxp_front_list *from) {
    to->count = 0;
    return gxp_append_front(body, to, from->data, from->count);
}

/* The index of a cell among the near ones, or GXP_NONE */
static uint32_t gxp_close_index(const gxp_vicinity *near, uint32_t cell) {
    const uint32_t index = cell < near->of_cell.count ? near->of_cell.data[cell] : GXP_NONE;
    return index < near->count && near->cells[index].cell == cell ? index : GXP_NONE;
}

/* The layer of a cell, or GXP_NONE */
static uint32_t gxp_layer_of(const gxp_vicinity *near, uint32_t cell) {
    const uint32_t index = gxp_close_index(near, cell);
    return index == GXP_NONE ? GXP_NONE : near->cells[index].layer;
}

/* The layer to which a cell belonged at the last move, or GXP_NONE. Parts of a cell that was divided since inherit. */
static uint32_t gxp_old_layer(const gx_blade *blade, uint32_t cell) {
    const gxp_keys *members = &blade->now.members;
    const uint32_t *parent = blade->body->slots.parent;
    uint32_t slot = blade->body->cells.slot[cell], i;
    while (slot >= blade->now.slot_count && parent[slot] != slot) slot = parent[slot];
    i = gxp_first_key(members, (uint64_t)slot << 32);
    return i < members->count && GXP_FIRST(members->data[i]) == slot ? GXP_SECOND(members->data[i]) : GXP_NONE;
}

/* Where a material point is now, as a layer has it: by a cell of a vertex' element that belongs to the layer, if there
   is one, and that contains the vertex. old: the layer is one of the last move's. Returns x as it was if the element is
   no more. */
static gx_result gxp_place_by(gx_blade *blade, uint32_t layer, int old, const gxp_front_vertex *v,
                              const double point[3], double x[3]) {
    static const double origin[3] = {0, 0, 0};
    gx_body *body = blade->body;
    uint32_t cell, best = GXP_NONE, most = 0, holder = GXP_NONE;
    double corners[4][3], weights[4];
    gx_result result = GX_OK;
    if (body->cells.data[v->element].next != GXP_NONE) result = gxp_cell_at(body, v->element, v->rest, &holder);
    for (cell = v->element; cell != GXP_NONE; cell = body->cells.data[cell].next) {
        const uint32_t own = old ? gxp_old_layer(blade, cell) : gxp_layer_of(&blade->near, cell),
                       rank = 1 + 2 * (uint32_t)(own == layer) + (uint32_t)(cell == holder);
        if (!body->cells.data[cell].kept || rank <= most) continue;
        most = rank;
        best = cell;
    }
    if (best == GXP_NONE || result != GX_OK) return result;
    gxp_cell_corners(body, &body->cells.data[best], 0, origin, corners);
    gxp_tet_weights(corners, point, weights);
    gxp_image_by(body, &body->cells.data[best], weights, x);
    return GX_OK;
}

/* Where a vertex of a front is now, as a layer has it */
static gx_result gxp_front_position(gx_blade *blade, uint32_t layer, int old, const gxp_front_vertex *v, double x[3]) {
    memcpy(x, v->position, 3 * sizeof *x);
    return gxp_place_by(blade, layer, old, v, v->extended, x);
}

/* A place on the edge: index of its point, + share of the way to the next */
static void gxp_edge_position(const double *edge, uint32_t count, double along, double x[3]) {
    const uint32_t i = along < count - 2 ? (uint32_t)along : count - 2;
    const double share = along - i;
    int k;
    for (k = 0; k < 3; k++) {
        const double a = edge[3 * (size_t)i + (size_t)k], b = edge[3 * (size_t)i + 3 + (size_t)k];
        x[k] = share <= 0 ? a : share >= 1 ? b : a + share * (b - a);
    }
}

/* The place on the edge that is nearest to a point: *along. Returns the squared distance. */
static double gxp_onto_edge(const double *edge, uint32_t count, const double x[3], double *along) {
    double best = HUGE_VAL;
    uint32_t i;
    *along = 0; /* where all squares are beyond all numbers */
    for (i = 0; i + 1 < count; i++) {
        double share, nearest[3];
        const double square = gxp_onto_segment(x, edge + 3 * (size_t)i, edge + 3 * (size_t)i + 3, &share, nearest);
        if (square >= best) continue;
        best = square;
        *along = i + share;
    }
    return best;
}

static gx_result gxp_push_quad(gx_blade *blade, const double *a, const double *b, const double *c, const double *d) {
    gx_result result = gxp_push_point(blade->body, &blade->quads, a);
    if (result == GX_OK) result = gxp_push_point(blade->body, &blade->quads, b);
    if (result == GX_OK) result = gxp_push_point(blade->body, &blade->quads, c);
    return result == GX_OK ? gxp_push_point(blade->body, &blade->quads, d) : result;
}

/* How many pieces of about twice the largest element a segment of the edge has. Far ends are long pieces: no cell is
   there. */
static uint32_t gxp_part_count(const gx_blade *blade, const double *ends) {
    const double length = sqrt(gxp_square_distance(ends, ends + 3));
    return length < 200 * blade->largest ? 1 + (uint32_t)(0.5 * length / blade->largest) : 100;
}

/* The part of the edge between two of its points, from the last move's place to the new one, piece by piece */
static gx_result gxp_sweep_segment(gx_blade *blade, const double *before, const double *after) {
    double from[4][3];
    const uint32_t parts = gxp_part_count(blade, after);
    uint32_t i;
    int k, n;
    gx_result result = GX_OK;
    for (i = 0; i < parts && result == GX_OK; i++) {
        for (n = 0; n < 2; n++)
            for (k = 0; k < 3; k++) {
                const double share = (double)(i + (uint32_t)n) / parts;
                from[n][k] = before[k] + share * (before[3 + k] - before[k]);
                from[3 - n][k] = after[k] + share * (after[3 + k] - after[k]);
            }
        result = gxp_push_quad(blade, from[0], from[1], from[2], from[3]);
    }
    return result;
}

/* The strip that the edge may have swept since the fronts were cut: from the edge before, and from the place where each
   front is now */
static gx_result gxp_sweep(gx_blade *blade, const double *before, const double *edge, uint32_t count) {
    const gxp_blade_state *now = &blade->now;
    uint32_t i, j;
    gx_result result = GX_OK;
    blade->quads.count = 0;
    for (i = 0; i + 1 < count && result == GX_OK; i++)
        result = gxp_sweep_segment(blade, before + 3 * (size_t)i, edge + 3 * (size_t)i);
    for (j = 0; j < now->layers.count && result == GX_OK; j++) {
        const gxp_front_vertex *v = now->vertices.data + now->layers.data[j].front;
        for (i = 0; i + 1 < now->layers.data[j].front_count && result == GX_OK; i++) {
            double x[4][3], along;
            if (v[i].gap) continue;
            result = gxp_front_position(blade, j, 1, &v[i], x[0]);
            if (result == GX_OK) result = gxp_front_position(blade, j, 1, &v[i + 1], x[1]);
            gxp_onto_edge(edge, count, x[1], &along);
            gxp_edge_position(edge, count, along, x[2]);
            gxp_onto_edge(edge, count, x[0], &along);
            gxp_edge_position(edge, count, along, x[3]);
            if (result == GX_OK) result = gxp_push_quad(blade, x[0], x[1], x[2], x[3]);
        }
    }
    return result;
}

/* Triangles of less sine than 2^-20 at their first corner have no plane: what is near them is near their edges. */
#define GXP_NO_PLANE 9.094947017729282e-13 /* 2^-40 */

static void gxp_set_plate(gxp_plate *p, const double *a, const double *b, const double *c) {
    const double *x[3] = {a, b, c};
    int i, k;
    for (i = 0; i < 3; i++) {
        memcpy(p->x[i], x[i], sizeof p->x[i]);
        for (k = 0; k < 3; k++) p->along[i][k] = x[(i + 1) % 3][k] - x[i][k];
        p->size[i] = gxp_dot(p->along[i], p->along[i]);
    }
    gxp_cross(p->normal, p->along[0], p->along[1]);
    p->square = gxp_dot(p->normal, p->normal);
    if (!(p->square > GXP_NO_PLANE * p->size[0] * p->size[1])) p->square = 0;
    for (i = 0; i < 3; i++) gxp_cross(p->over[i], p->normal, p->along[i]);
}

/* Is a ball within a distance of a triangle? least: radius + distance */
static int gxp_is_near_plate(const gxp_plate *p, const double middle[3], double least) {
    const double square = least * least;
    double way[3][3];
    int i, k, beyond = 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) way[i][k] = middle[k] - p->x[i][k];
    for (k = 0; k < 3; k++) {
        beyond |= way[0][k] < -least && way[1][k] < -least && way[2][k] < -least;
        beyond |= way[0][k] > least && way[1][k] > least && way[2][k] > least;
    }
    if (beyond) return 0;
    if (p->square > 0) {
        const double height = gxp_dot(p->normal, way[0]);
        if (height * height > square * p->square) return 0;
        if (gxp_dot(p->over[0], way[0]) >= 0 && gxp_dot(p->over[1], way[1]) >= 0 && gxp_dot(p->over[2], way[2]) >= 0)
            return 1;
    }
    for (i = 0; i < 3; i++) {
        const double far = gxp_dot(way[i], way[i]), along = gxp_dot(way[i], p->along[i]);
        if (far <= square) return 1;
        if (along > 0 && along < p->size[i] && far * p->size[i] - along * along <= square * p->size[i]) return 1;
    }
    return 0;
}

static gx_result gxp_plates_room(gx_blade *blade, uint32_t count) {
    const gx_allocator *a = &blade->body->config.allocator;
    return gxp_reserve(a, &blade->plates, sizeof *blade->plates, 0, &blade->plate_capacity, count);
}

/* Prepares the two triangles of each quad, and the boxes in which cells are looked at. */
static gx_result gxp_prepare_quads(gx_blade *blade) {
    const uint32_t count = blade->quads.count / 4;
    uint32_t q;
    int k;
    gx_result result = gxp_plates_room(blade, 2 * count);
    if (result == GX_OK)
        result = gxp_reserve(&blade->body->config.allocator, &blade->boxes, sizeof *blade->boxes, 0,
                             &blade->box_capacity, count);
    for (q = 0; q < count && result == GX_OK; q++) {
        const double *x = blade->quads.data + 12 * (size_t)q;
        gxp_set_plate(&blade->plates[2 * q], x, x + 3, x + 6);
        gxp_set_plate(&blade->plates[2 * q + 1], x, x + 6, x + 9);
        for (k = 0; k < 3; k++) {
            const double of[4] = {x[k], x[3 + k], x[6 + k], x[9 + k]};
            blade->boxes[q].low[k] = gxp_least(of) - blade->largest;
            blade->boxes[q].high[k] = gxp_greatest(of) + blade->largest;
        }
    }
    return result;
}

/* What contains a bent cell is larger than what contains its corners. */
static void gxp_contain_bent(const gx_body *body, gxp_close_cell *c) {
    const gxp_cell *row = &body->cells.data[c->cell];
    gxp_bounds box;
    int k;
    gxp_cell_bounds(body, row->element, row, &box);
    for (k = 0; k < 3; k++) {
        c->low[k] = box.low[k];
        c->high[k] = box.high[k];
        c->middle[k] = 0.5 * box.low[k] + 0.5 * box.high[k];
    }
    c->radius = sqrt(gxp_square_distance(c->middle, c->high));
}

/* The place that a near cell's map has at a point of space */
static void gxp_near_weights(const gx_body *body, gxp_close_cell *c, const double x[3], double weights[4]) {
    if (c->is_bent)
        gxp_place_by_map(body, &body->cells.data[c->cell], x, weights);
    else
        gxp_tet_weights(c->corners, x, weights);
}

/* The deformed corners of a cell, and what contains them */
static void gxp_place_near(const gx_body *body, gxp_close_cell *c) {
    const gxp_cell *row = &body->cells.data[c->cell];
    double moved[12];
    int n, k;
    gxp_moved_corners(body, row, moved);
    memcpy(c->corners, moved, sizeof moved);
    for (k = 0; k < 3; k++) {
        const double x[4] = {c->corners[0][k], c->corners[1][k], c->corners[2][k], c->corners[3][k]};
        c->low[k] = gxp_least(x);
        c->high[k] = gxp_greatest(x);
        c->middle[k] = 0.25 * (x[0] + x[1] + x[2] + x[3]);
    }
    c->radius = 0;
    for (n = 0; n < 4; n++) c->radius = gxp_more(c->radius, gxp_square_distance(c->middle, c->corners[n]));
    c->radius = sqrt(c->radius);
    c->is_bent = (uint8_t)gxp_is_bent(body, row);
    if (c->is_bent) gxp_contain_bent(body, c);
    c->is_divided = (uint8_t)(gxb_complex_root(body->complex, row->element) & 1);
    c->has_facets = c->has_heights = 0;
    c->size = body->mesh.sizes[row->element];
}

/* Appends a cell to the near ones. */
static gx_result gxp_push_near(gx_blade *blade, const gxp_close_cell *c) {
    gxp_vicinity *near = &blade->near;
    const gx_result result =
        gxp_reserve(&blade->body->config.allocator, &near->cells, sizeof *near->cells, near->count, &near->capacity, 1);
    if (result != GX_OK) return result;
    near->of_cell.data[c->cell] = near->count;
    near->cells[near->count] = *c;
    near->cells[near->count++].stretch = gxp_stretch(blade->body, c->cell);
    return GX_OK;
}

typedef struct gxp_vicinity_walk {
    gxp_boxes_walk walk;
    gx_blade *blade;
    const gxp_words *scope; /* by fragment, 1 if it is in the scope; NULL: all are */
} gxp_vicinity_walk;

/* Looks at the cells of an element: they are near if they are within an element's size of a quad in whose box they
   are. */
static gx_result gxp_add_near_cells(gx_body *body, gxp_boxes_walk *walk, uint32_t place, const uint32_t *met,
                                    uint32_t count) {
    const gxp_vicinity_walk *own = (const gxp_vicinity_walk *)(const void *)walk;
    gx_blade *blade = own->blade;
    uint32_t cell, i;
    gx_result result = GX_OK;
    for (cell = body->mesh.box_elements[place]; cell != GXP_NONE && result == GX_OK;
         cell = body->cells.data[cell].next) {
        gxp_close_cell c;
        gxp_bounds box;
        if (!body->cells.data[cell].kept) continue;
        if (own->scope != NULL && !own->scope->data[gxp_cell_fragment(body, cell)]) continue;
        c.cell = cell;
        gxp_place_near(body, &c);
        memcpy(box.low, c.low, sizeof box.low);
        memcpy(box.high, c.high, sizeof box.high);
        for (i = 0, c.quad = GXP_NONE; i < count; i++) {
            if (gxp_gap(&blade->boxes[met[i]], &box) > 0) continue;
            if (c.quad == GXP_NONE) c.quad = met[i];
            if (gxp_is_near_plate(&blade->plates[2 * met[i]], c.middle, c.radius + c.size) ||
                gxp_is_near_plate(&blade->plates[2 * met[i] + 1], c.middle, c.radius + c.size))
                break;
        }
        if (i < count) result = gxp_push_near(blade, &c);
    }
    return result;
}

/* Ranks the near cells by their first quads; those of one quad in the order in which they were found. */
static gx_result gxp_rank_near(gx_blade *blade) {
    gxp_vicinity *near = &blade->near;
    const uint32_t quads = blade->quads.count / 4 + 1; /* the last one for cells without */
    uint32_t i, sum = 0;
    gx_result result = gxp_start_words(blade->body, &near->quad_start, quads);
    if (result == GX_OK) result = gxp_start_words(blade->body, &near->ranked, near->count);
    if (result != GX_OK) return result;
    memset(near->quad_start.data, 0, quads * sizeof *near->quad_start.data);
    for (i = 0; i < near->count; i++) near->quad_start.data[near->cells[i].quad]++;
    for (i = 0; i < quads; i++) {
        const uint32_t count = near->quad_start.data[i];
        near->quad_start.data[i] = sum;
        sum += count;
    }
    for (i = 0; i < near->count; i++) near->ranked.data[near->quad_start.data[near->cells[i].quad]++] = i;
    near->ranked.count = near->count;
    return GX_OK;
}

/* Unites near cells that share a copy. */
static void gxp_join_near(gx_blade *blade) {
    gxp_vicinity *near = &blade->near;
    const gx_body *body = blade->body;
    uint32_t *first = near->of_copy.data, i, k;
    for (i = 0; i < near->count; i++) {
        const uint32_t *copies = body->cells.data[near->cells[near->ranked.data[i]].cell].copies;
        for (k = 0; k < 4; k++)
            if (first[copies[k]] == 0)
                first[copies[k]] = i + 1;
            else
                gxp_unite(near->parents.data, first[copies[k]] - 1, i);
    }
    for (i = 0; i < near->count; i++)
        for (k = 0; k < 4; k++) first[body->cells.data[near->cells[i].cell].copies[k]] = 0;
}

/* Words by cell or copy, which keep what they have; new ones are 0. */
static gx_result gxp_extend_words(gx_body *body, gxp_words *words, uint32_t count) {
    gx_result result;
    if (count <= words->count) return GX_OK;
    result = gxp_words_room(body, words, count - words->count);
    if (result != GX_OK) return result;
    memset(words->data + words->count, 0, (count - words->count) * sizeof *words->data);
    words->count = count;
    return GX_OK;
}

/* Numbers the layers in the order of their first cells. */
static gx_result gxp_number_layers(gx_blade *blade) {
    gxp_vicinity *near = &blade->near;
    gx_body *body = blade->body;
    uint32_t i;
    gx_result result = gxp_rank_near(blade);
    if (result == GX_OK) result = gxp_extend_words(body, &near->of_copy, body->copies.count);
    if (result == GX_OK) result = gxp_start_words(body, &near->parents, near->count);
    if (result != GX_OK) return result;
    for (i = 0; i < near->count; i++) near->parents.data[i] = i;
    near->parents.count = near->count;
    gxp_join_near(blade);
    near->layer_count = 0;
    for (i = 0; i < near->count; i++) {
        const uint32_t root = gxp_find(near->parents.data, i);
        near->cells[near->ranked.data[i]].layer =
            root == i ? near->layer_count++ : near->cells[near->ranked.data[root]].layer;
    }
    return GX_OK;
}

/* Orders the cells of each layer along the axis along which the edge is longest, so that searches look at few. */
static gx_result gxp_order_near(gx_blade *blade) {
    gxp_vicinity *near = &blade->near;
    gx_body *body = blade->body;
    double low = 0, high = 0;
    uint32_t i, sum = 0;
    gx_result result = gxp_start_words(body, &near->layer_start, (size_t)near->layer_count + 1);
    near->order.count = 0;
    if (result == GX_OK) result = gxp_keys_room(body, &near->order, 3 * (size_t)near->count);
    if (result != GX_OK) return result;
    near->layer_start.count = near->layer_count + 1;
    memset(near->layer_start.data, 0, near->layer_start.count * sizeof *near->layer_start.data);
    near->widest = 0;
    for (i = 0; i < near->count; i++) {
        const gxp_close_cell *c = &near->cells[i];
        low = i == 0 || c->low[near->axis] < low ? c->low[near->axis] : low;
        high = i == 0 || c->low[near->axis] > high ? c->low[near->axis] : high;
        near->widest = fmax(near->widest, c->high[near->axis] - c->low[near->axis]);
        near->layer_start.data[c->layer]++;
    }
    for (i = 0; i <= near->layer_count; i++) {
        const uint32_t count = near->layer_start.data[i];
        near->layer_start.data[i] = sum;
        sum += count;
    }
    for (i = 0; i < near->count; i++) {
        const double at = near->cells[near->ranked.data[i]].low[near->axis],
                     share = high > low ? (at - low) / (high - low) : 0;
        near->order.data[near->order.count++] = (uint64_t)(4294967295.0 * share) << 32 | i;
    }
    result = gxp_sort_keys(body, &near->order, 0, near->count);
    if (result != GX_OK) return result;
    for (i = 0; i < near->count; i++) { /* by layer, stable */
        const uint64_t key = near->order.data[i];
        const uint32_t cell = near->ranked.data[GXP_SECOND(key)];
        near->order.data[near->count + near->layer_start.data[near->cells[cell].layer]++] =
            (key & 0xffffffff00000000u) | cell;
    }
    if (near->count > 0)
        memcpy(near->order.data, near->order.data + near->count, near->count * sizeof *near->order.data);
    for (i = near->layer_count; i > 0; i--) near->layer_start.data[i] = near->layer_start.data[i - 1];
    near->layer_start.data[0] = 0;
    return GX_OK;
}

/* Boxes of the tree that are out of date by less, in mean sizes of elements, are not fitted again for a blade. */
#define GXP_NEAR_SLACK 0.75

/* Brings the tree of boxes up to date for the blade. Blames a copy that is not finite or out of range. */
static gx_result gxp_refit_near(gx_blade *blade, double most, gx_failure *failure) {
    uint32_t wild;
    const gx_result result = gxp_refit_loosely(blade->body, most * blade->body->mesh.mean_size, &blade->slack);
    if (gxp_end(failure, result) != GX_OK) return result;
    wild = gxp_wild_copy(blade->body);
    return wild == GXP_NONE ? GX_OK : gxp_check_copy(blade->body, wild, failure);
}

/* Finds the cells near the quads. scope: by fragment, 1 if it is in the scope; NULL: all are. */
static gx_result gxp_find_near(gx_blade *blade, const gxp_words *scope) {
    gx_body *body = blade->body;
    gxp_vicinity_walk own;
    gx_result result = gxp_extend_words(body, &blade->near.of_cell, body->cells.count);
    if (result == GX_OK) result = gxp_prepare_quads(blade);
    blade->near.count = blade->near.facet_count = 0;
    if (result != GX_OK) return result;
    own.walk.visit = gxp_add_near_cells;
    own.walk.boxes = blade->boxes;
    own.walk.slack = blade->slack;
    own.blade = blade;
    own.scope = scope;
    return gxp_meet_boxes(body, &own.walk, blade->quads.count / 4);
}

/* Finds the near cells and their layers. */
static gx_result gxp_find_layers(gx_blade *blade, const double *before, const double *edge, uint32_t count,
                                 const gxp_words *scope) {
    const double *last = edge + 3 * ((size_t)count - 1);
    int k;
    gx_result result = gxp_sweep(blade, before, edge, count);
    if (result == GX_OK) result = gxp_find_near(blade, scope);
    if (result == GX_OK) result = gxp_number_layers(blade);
    blade->near.axis = 0;
    for (k = 1; k < 3; k++)
        if (fabs(last[k] - edge[k]) > fabs(last[blade->near.axis] - edge[blade->near.axis])) blade->near.axis = k;
    return result == GX_OK ? gxp_order_near(blade) : result;
}

/* >>edges: the edge as a layer sees it ----------------------------------------------------------------------------- */
/* In: a layer and the edge. Out: places on the edge with their material points: few where the layer is not, or where
   they lie on a line. In the air the map of the nearest cell is extended. Touches the blade's working memory. */

/* Cells of less volume, as a share of that at rest, map nothing back: other cells are near. Nor do those of more: where
   displacements are huge, places next to each other come from anywhere in the material. */
#define GXP_FLAT_MAP  1e-3
#define GXP_BLOWN_MAP 1e3
/* The parts of an edge near a layer end this far from it, in element sizes. */
#define GXP_CAP 1.25
/* In the air, places that are seen are at most this share of their distances from the layer apart. */
#define GXP_AIR 0.5

typedef struct gxp_sight { /* what a search for the nearest cell of a layer has found */
    uint32_t index;        /* of a near cell, GXP_NONE: none */
    double square;         /* of the distance, m2; 0: inside */
    double nearest[3];     /* in space */
    double weights[4];     /* of the place, by the corners of that cell */
    int wall;              /* 1: the nearest point is on a wall of the cell */
} gxp_sight;

static double gxp_square_to_box(const double x[3], const double low[3], const double high[3]) {
    double square = 0;
    int k;
    for (k = 0; k < 3; k++) {
        const double d = x[k] < low[k] ? low[k] - x[k] : x[k] > high[k] ? x[k] - high[k] : 0;
        square += d * d;
    }
    return square;
}

/* Is the place, of these weights in the cell's element, in the cell's own part? */
static gx_result gxp_is_own_part(gx_body *body, const gxp_close_cell *c, const double weights[4], int *own) {
    static const double origin[3] = {0, 0, 0};
    const gxp_cell *row = &body->cells.data[c->cell];
    double corners[4][3], rest[3];
    uint32_t holder = c->cell;
    gx_result result;
    *own = 1;
    if (!c->is_divided) return GX_OK;
    gxp_cell_corners(body, row, 0, origin, corners);
    gxp_weigh(corners, weights, rest);
    result = gxp_cell_at(body, row->element, rest, &holder);
    *own = holder == c->cell;
    return result;
}

/* On which face of its element is a triangle that bounds a cell? 4: on none, it is a wall. */
static uint32_t gxp_facet_face(const double *lambda[3]) {
    uint32_t face = 0;
    while (face < 4 && (lambda[0][face] > 0 || lambda[1][face] > 0 || lambda[2][face] > 0)) face++;
    return face;
}

/* Lists the triangles that bound the cell of a divided element. */
static gx_result gxp_list_facets(gx_blade *blade, gxp_close_cell *c) {
    gx_body *body = blade->body;
    gxp_vicinity *near = &blade->near;
    const gxp_boundary *boundary = &body->scratch.boundary;
    gxp_close_facet *facet;
    uint32_t i;
    int n, k;
    gx_result result;
    gxp_clear_boundary(body, 1);
    result = gxp_bound_cell(body, c->cell, 1);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &near->facets, sizeof *near->facets, near->facet_count,
                             &near->facet_capacity, boundary->triangles.count / 3);
    if (result != GX_OK) return result;
    c->facets = near->facet_count;
    c->facet_count = boundary->triangles.count / 3;
    c->has_facets = 1;
    near->facet_count += c->facet_count;
    for (i = 0, facet = near->facets + c->facets; i < c->facet_count; i++, facet++) {
        const double *lambda[3];
        for (n = 0; n < 3; n++) {
            const double *l = lambda[n] = boundary->lambdas + 4 * (size_t)boundary->triangles.data[3 * i + (uint32_t)n];
            for (k = 0; k < 3; k++)
                facet->corners[n][k] = l[0] * c->corners[0][k] + l[1] * c->corners[1][k] + l[2] * c->corners[2][k] +
                                       l[3] * c->corners[3][k];
            if (c->is_bent) gxp_image_of_bent(body, &body->cells.data[c->cell], l, facet->corners[n]);
        }
        facet->face = gxp_facet_face(lambda);
    }
    return GX_OK;
}

/* How high each corner is over the face opposite to it */
static void gxp_measure_heights(gxp_close_cell *c) {
    int i, k;
    for (i = 0; i < 4; i++) {
        const double *a = c->corners[gxp_outward[i][0]], *b = c->corners[gxp_outward[i][1]],
                     *d = c->corners[gxp_outward[i][2]];
        double u[3], v[3], w[3], normal[3];
        for (k = 0; k < 3; k++) {
            u[k] = b[k] - a[k];
            v[k] = d[k] - a[k];
            w[k] = c->corners[i][k] - a[k];
        }
        gxp_cross(normal, u, v);
        c->heights[i] = fabs(gxp_dot(normal, w)) / sqrt(gxp_dot(normal, normal));
    }
    c->has_heights = 1;
}

/* A square of a distance that is smaller than another one by more than this factor is so for sure. */
#define GXP_SURELY 0.999999

/* A triangle that bounds a cell: is it nearer to the place than what was found before? face: see gxp_close_facet */
static void gxp_seek_triangle(uint32_t index, const double x[3], const double weights[4], const double *a,
                              const double *b, const double *c, uint32_t face, gxp_sight *sight) {
    double nearest[3];
    const double square = gxp_onto_triangle(x, a, b, c, nearest);
    if (square >= sight->square) return;
    sight->index = index;
    sight->square = square;
    sight->wall = face == 4;
    memcpy(sight->nearest, nearest, sizeof nearest);
    memcpy(sight->weights, weights, sizeof sight->weights);
}

/* A cell that does not contain the place: is its material nearer than what was found before? The nearest point of its
   surface is on a wall, or on a face whose outer side the place is on. */
static gx_result gxp_seek_outside(gx_blade *blade, uint32_t index, const double x[3], gxp_sight *sight) {
    gxp_close_cell *c = &blade->near.cells[index];
    double weights[4], beyond[5];
    uint32_t i;
    if (gxp_square_to_box(x, c->low, c->high) >= sight->square) return GX_OK;
    if (c->stretch < GXP_FLAT_MAP || c->stretch > GXP_BLOWN_MAP) return GX_OK; /* inverted: outside is inside */
    gxp_near_weights(blade->body, c, x, weights);
    if (!c->has_heights) gxp_measure_heights(c);
    beyond[4] = 0;
    for (i = 0; i < 4; i++) {
        const double off = c->is_bent ? 0 : weights[i] * c->heights[i]; /* a curved face is at any distance */
        beyond[i] = weights[i] < 0 ? GXP_SURELY * off * off : HUGE_VAL;
        if (weights[i] < 0 && beyond[i] >= sight->square) return GX_OK;
    }
    if (c->is_divided && !c->has_facets) {
        const gx_result result = gxp_list_facets(blade, c);
        if (result != GX_OK) return result;
    }
    for (i = 0; i < 4 && !c->is_divided; i++)
        if (beyond[i] < sight->square)
            gxp_seek_triangle(index, x, weights, c->corners[gxp_outward[i][0]], c->corners[gxp_outward[i][1]],
                              c->corners[gxp_outward[i][2]], i, sight);
    for (i = 0; i < c->facet_count && c->is_divided; i++) {
        const gxp_close_facet *f = &blade->near.facets[c->facets + i];
        if (beyond[f->face] < sight->square)
            gxp_seek_triangle(index, x, weights, f->corners[0], f->corners[1], f->corners[2], f->face, sight);
    }
    return GX_OK;
}

/* Does a cell contain the place? Then it is found. */
static gx_result gxp_seek_inside(gx_blade *blade, uint32_t index, const double x[3], gxp_sight *sight) {
    gxp_close_cell *c = &blade->near.cells[index];
    double weights[4];
    int own = 0;
    gx_result result = GX_OK;
    if (gxp_square_to_box(x, c->low, c->high) > 0) return GX_OK;
    if (fabs(c->stretch) < GXP_FLAT_MAP || fabs(c->stretch) > GXP_BLOWN_MAP) return GX_OK;
    gxp_near_weights(blade->body, c, x, weights);
    if (weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0 && weights[3] >= 0)
        result = gxp_is_own_part(blade->body, c, weights, &own);
    if (!own || result != GX_OK) return result;
    sight->index = index;
    sight->square = 0;
    sight->wall = 0;
    memcpy(sight->nearest, x, sizeof sight->nearest);
    memcpy(sight->weights, weights, sizeof sight->weights);
    return GX_OK;
}

/* Finds the cell of a layer that contains a place, or else the nearest one. */
static gx_result gxp_seek(gx_blade *blade, uint32_t layer, const double x[3], gxp_sight *sight) {
    const gxp_vicinity *near = &blade->near;
    const double along = x[near->axis];
    const int go_on = blade->last_sight < near->count && near->cells[blade->last_sight].layer == layer;
    uint32_t low = near->layer_start.data[layer], high = near->layer_start.data[layer + 1], first = low, end = high, i;
    gx_result result = GX_OK;
    sight->index = GXP_NONE;
    sight->square = HUGE_VAL;
    if (go_on) result = gxp_seek_inside(blade, blade->last_sight, x, sight);
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (near->cells[GXP_SECOND(near->order.data[middle])].low[near->axis] <= along)
            low = middle + 1;
        else
            high = middle;
    }
    for (i = low; i > first && result == GX_OK && sight->square > 0; i--) {
        const uint32_t index = GXP_SECOND(near->order.data[i - 1]);
        if (along - near->cells[index].low[near->axis] > near->widest) break;
        result = gxp_seek_inside(blade, index, x, sight);
    }
    if (go_on && result == GX_OK && sight->square > 0) result = gxp_seek_outside(blade, blade->last_sight, x, sight);
    for (i = low; i > first && result == GX_OK && sight->square > 0; i--) {
        const uint32_t index = GXP_SECOND(near->order.data[i - 1]);
        const double off = along - near->cells[index].low[near->axis] - near->widest;
        if (off > 0 && off * off >= sight->square) break;
        result = gxp_seek_outside(blade, index, x, sight);
    }
    for (i = low; i < end && result == GX_OK && sight->square > 0; i++) {
        const uint32_t index = GXP_SECOND(near->order.data[i]);
        const double off = near->cells[index].low[near->axis] - along;
        if (off * off >= sight->square) break;
        result = gxp_seek_outside(blade, index, x, sight);
    }
    return result;
}

/* The cell that has a material point, GXP_NONE: there is none */
static gx_result gxp_find_rest_cell(gx_body *body, const double rest[3], uint32_t *cell) {
    uint32_t stack[128], depth = 0, i;
    int k;
    *cell = GXP_NONE;
    stack[depth++] = 0;
    while (depth > 0) {
        const gxp_box *box = &body->mesh.boxes[stack[--depth]];
        int beyond = 0;
        for (k = 0; k < 3; k++) beyond |= rest[k] < box->low[k] || rest[k] > box->high[k];
        if (beyond) continue;
        if (box->count == 0) {
            stack[depth++] = box->first + 1;
            stack[depth++] = box->first;
        }
        for (i = 0; i < box->count; i++) {
            const uint32_t element = body->mesh.box_elements[box->first + i];
            if (gxp_element_side(body, element, rest) >= 0) return gxp_cell_at(body, element, rest, cell);
        }
    }
    return GX_OK;
}

/* Is there material of the layer at a material point? */
static gx_result gxp_is_in_layer(gx_blade *blade, uint32_t layer, const double rest[3], int *inside) {
    uint32_t cell = GXP_NONE;
    const gx_result result = gxp_find_rest_cell(blade->body, rest, &cell);
    *inside = cell != GXP_NONE && gxp_layer_of(&blade->near, cell) == layer;
    return result;
}

/* The material point of a place in the air, at most an element's size away from the nearest one of the layer's
   surface. It moves towards that one while there is material of the layer: the map extended is not the layer's. */
static gx_result gxp_place_in_air(gx_blade *blade, uint32_t layer, const gxp_sight *sight, double corners[4][3],
                                  gxp_front_vertex *v) {
    gxp_close_cell *c = &blade->near.cells[sight->index];
    double weights[4], surface[3], position[3], away;
    const double reach = GXP_CAP * v->size, share = v->distance > reach ? reach / v->distance : 1;
    int k, tries, inside = 1;
    gx_result result = GX_OK;
    gxp_near_weights(blade->body, c, sight->nearest, weights);
    gxp_weigh(corners, weights, surface);
    memcpy(v->foot, surface, sizeof surface);
    memcpy(v->foot_at, sight->nearest, sizeof v->foot_at);
    for (k = 0; k < 3; k++) position[k] = sight->nearest[k] + share * (v->position[k] - sight->nearest[k]);
    gxp_near_weights(blade->body, c, position, weights);
    gxp_weigh(corners, weights, v->rest);
    away = sqrt(gxp_square_distance(v->rest, surface));
    if (away > 1.5 * c->size)
        for (k = 0; k < 3; k++) v->rest[k] = surface[k] + 1.5 * c->size / away * (v->rest[k] - surface[k]);
    for (tries = 0; tries < 6 && inside && result == GX_OK; tries++) {
        result = gxp_is_in_layer(blade, layer, v->rest, &inside);
        if (inside && sight->wall) {
            memcpy(v->rest, surface, sizeof surface);
            v->walled = 1;
            break;
        }
        for (k = 0; k < 3 && inside; k++) v->rest[k] = surface[k] + 0.4 * (v->rest[k] - surface[k]);
    }
    return result;
}

/* The material point of what a search has found, by the map of its cell */
static void gxp_map_sight(const gx_blade *blade, const gxp_sight *sight, double rest[3]) {
    static const double origin[3] = {0, 0, 0};
    double corners[4][3];
    gxp_cell_corners(blade->body, &blade->body->cells.data[blade->near.cells[sight->index].cell], 0, origin, corners);
    gxp_weigh(corners, sight->weights, rest);
}

/* A place in the material that is farther from the one before it there than this, in distances in space, may be in
   other cells of its layer too. */
#define GXP_LEAP 2.0

/* Where a layer lies over itself, a place is in several of its cells. The one whose material is nearest to that of the
   place before it is meant: the edge goes on in the same part of the layer until it leaves that. */
static gx_result gxp_seek_beside(gx_blade *blade, uint32_t layer, const gxp_front_vertex *v,
                                 const gxp_front_vertex *beside, gxp_sight *sight) {
    const gxp_vicinity *near = &blade->near;
    const double reach = GXP_LEAP * sqrt(gxp_square_distance(v->position, beside->position));
    double rest[3], least;
    uint32_t i;
    gx_result result = GX_OK;
    gxp_map_sight(blade, sight, rest);
    least = gxp_square_distance(rest, beside->rest);
    for (i = near->layer_start.data[layer]; i < near->layer_start.data[layer + 1] && result == GX_OK; i++) {
        gxp_sight other;
        double square;
        if (least <= reach * reach) break;
        other.index = GXP_NONE;
        result = gxp_seek_inside(blade, GXP_SECOND(near->order.data[i]), v->position, &other);
        if (result != GX_OK || other.index == GXP_NONE) continue;
        gxp_map_sight(blade, &other, rest);
        square = gxp_square_distance(rest, beside->rest);
        if (square >= least) continue;
        least = square;
        *sight = other;
    }
    return result;
}

/* How a layer sees a place in space: v->position is given. beside: a place next to it on the edge, or NULL */
static gx_result gxp_see_place(gx_blade *blade, uint32_t layer, const gxp_front_vertex *beside, gxp_front_vertex *v) {
    static const double origin[3] = {0, 0, 0};
    const gxp_vicinity *near = &blade->near;
    const gxp_close_cell *c;
    double corners[4][3];
    gxp_sight sight;
    gx_result result = gxp_seek(blade, layer, v->position, &sight);
    if (result == GX_OK && beside != NULL && sight.index != GXP_NONE && !(sight.square > 0))
        result = gxp_seek_beside(blade, layer, v, beside, &sight);
    if (result != GX_OK) return result;
    c = &near->cells[sight.index != GXP_NONE ? sight.index
                                             : GXP_SECOND(near->order.data[near->layer_start.data[layer]])];
    v->element = blade->body->cells.data[c->cell].element;
    v->size = c->size;
    v->distance = sqrt(sight.square);
    blade->last_sight = sight.index;
    if (sight.index == GXP_NONE) { /* every cell is flat or inverted */
        memcpy(v->rest, v->position, sizeof v->rest);
        memcpy(v->extended, v->position, sizeof v->extended);
        memcpy(v->foot, v->position, sizeof v->foot);
        memcpy(v->foot_at, v->position, sizeof v->foot_at);
        return GX_OK;
    }
    gxp_cell_corners(blade->body, &blade->body->cells.data[c->cell], 0, origin, corners);
    gxp_weigh(corners, sight.weights, v->extended);
    memcpy(v->rest, v->extended, sizeof v->rest);
    memcpy(v->foot, v->rest, sizeof v->foot);
    memcpy(v->foot_at, v->position, sizeof v->foot_at);
    return v->distance > 0 ? gxp_place_in_air(blade, layer, &sight, corners, v) : GX_OK;
}

/* How a layer sees a place on the edge. beside: the place before it, or NULL */
static gx_result gxp_see(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count, double along,
                         const gxp_front_vertex *beside, gxp_front_vertex *v) {
    memset(v, 0, sizeof *v);
    v->along = along;
    gxp_edge_position(edge, count, along, v->position);
    return gxp_see_place(blade, layer, beside, v);
}

/* Are there places between two that must be seen? In the air the line between them must stay out of the layer: they
   are near to each other beside their distances from it. */
static int gxp_must_refine(const gx_blade *blade, const gxp_front_vertex *a, const gxp_front_vertex *b) {
    const double length = sqrt(gxp_square_distance(a->position, b->position));
    const double size = a->size < b->size ? a->size : b->size;
    if (blade->seen.count >= blade->max_samples) return 0;
    if (a->distance > 0 && b->distance > 0)
        return length > size * 0.125 && length > GXP_AIR * (a->distance + b->distance);
    return length > size * ((a->distance > 0) == (b->distance > 0) ? 0.5 : 0.125);
}

/* Appends what must be seen between two places. */
static gx_result gxp_refine(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count,
                            const gxp_front_vertex *a, const gxp_front_vertex *b) {
    gxp_front_vertex middle;
    const double along = 0.5 * a->along + 0.5 * b->along;
    gx_result result;
    if (!gxp_must_refine(blade, a, b) || !(along > a->along && along < b->along)) return GX_OK;
    result = gxp_see(blade, layer, edge, count, along, a, &middle);
    if (result == GX_OK) result = gxp_refine(blade, layer, edge, count, a, &middle);
    if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->seen, &middle);
    return result == GX_OK ? gxp_refine(blade, layer, edge, count, &middle, b) : result;
}

/* Flags the places that are needed for a polyline within a tolerance [Douglas, Peucker 1973]. */
static void gxp_keep_bends(const gxp_front_vertex *v, uint32_t first, uint32_t last, double tolerance, uint32_t *keep) {
    while (first + 1 < last) {
        double most = 0, share, at[3];
        uint32_t i, middle = first;
        for (i = first + 1; i < last; i++) {
            const double square = gxp_onto_segment(v[i].rest, v[first].rest, v[last].rest, &share, at);
            if (square > most) most = square, middle = i;
        }
        if (most <= tolerance * tolerance) return;
        keep[middle] = 1;
        gxp_keep_bends(v, first, middle, tolerance, keep);
        first = middle;
    }
}

/* Flags the places that tell where the layer is: the first and the last of each stretch of the edge in the layer, the
   middle one, and those next to it in the air. */
static void gxp_keep_stretches(const gxp_front_vertex *v, uint32_t first, uint32_t last, uint32_t *keep) {
    uint32_t i, j;
    for (i = first; i <= last; i = j) {
        for (j = i + 1; j <= last && (v[j].distance > 0) == (v[i].distance > 0); j++) {}
        keep[i] |= 2;
        keep[j - 1] |= 2;
        keep[i + (j - i) / 2] |= 2;
    }
}

/* Drops places on lines. */
static gx_result gxp_thin_run(gx_blade *blade, uint32_t first) {
    gxp_front_vertex *v = blade->samples.data;
    const uint32_t last = blade->samples.count - 1;
    uint32_t count = first, i, *needed;
    gx_result result = gxp_start_words(blade->body, &blade->needed, blade->samples.count);
    if (result != GX_OK) return result;
    needed = blade->needed.data;
    memset(needed, 0, blade->samples.count * sizeof *needed);
    needed[first] = needed[last] = 1;
    gxp_keep_bends(v, first, last, 0.5 * blade->tolerance, needed);
    gxp_keep_stretches(v, first, last, needed);
    for (i = first; i <= last; i++) {
        if (!needed[i]) continue;
        v[i].soft = needed[i] == 2;
        v[count++] = v[i];
    }
    v[count - 1].gap = 1;
    blade->samples.count = count;
    return GX_OK;
}

/* Appends the place at which the part of the edge that is near the layer ends: between a place seen near it and the
   next one, so far that the layer cannot be farther than GXP_CAP. */
static gx_result gxp_push_cap(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count,
                              const gxp_front_vertex *near, const gxp_front_vertex *far) {
    const double length = sqrt(gxp_square_distance(near->position, far->position)),
                 reach = fmax(GXP_CAP * near->size - near->distance, 0.25 * near->size);
    gxp_front_vertex v = *far;
    gx_result result = GX_OK;
    if (reach < length)
        result =
            gxp_see(blade, layer, edge, count, near->along + reach / length * (far->along - near->along), near, &v);
    return result == GX_OK ? gxp_push_vertex(blade->body, &blade->samples, &v) : result;
}

/* Is a place of the edge within an element's size of the layer, or not much farther than the nearest one? */
static int gxp_is_run(const gxp_front_vertex *v, double least) {
    return v->distance <= fmax(v->size, least + 0.5 * v->size);
}

/* Lists in blade.samples the parts of the edge that are near the layer, each with an end in the air on both sides. */
static gx_result gxp_list_runs(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count) {
    const gxp_front_list *seen = &blade->seen;
    double least = HUGE_VAL;
    uint32_t i, j;
    gx_result result = GX_OK;
    blade->samples.count = 0;
    for (i = 0; i < seen->count; i++) least = fmin(least, seen->data[i].distance);
    for (i = 0; i < seen->count && result == GX_OK; i = j + 1) {
        const uint32_t first = blade->samples.count;
        j = i;
        if (!gxp_is_run(&seen->data[i], least)) continue;
        while (j + 1 < seen->count && gxp_is_run(&seen->data[j + 1], least)) j++;
        if (i > 0) result = gxp_push_cap(blade, layer, edge, count, &seen->data[i], &seen->data[i - 1]);
        if (result == GX_OK) result = gxp_append_front(blade->body, &blade->samples, seen->data + i, j - i + 1);
        if (result == GX_OK && j + 1 < seen->count)
            result = gxp_push_cap(blade, layer, edge, count, &seen->data[j], &seen->data[j + 1]);
        if (result == GX_OK) result = gxp_thin_run(blade, first);
    }
    return result;
}

/* Lists in blade.samples how a layer sees the edge. */
static gx_result gxp_see_edge(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count) {
    gxp_front_vertex before, v;
    uint32_t i;
    gx_result result;
    blade->last_sight = GXP_NONE;
    blade->seen.count = 0;
    result = gxp_see(blade, layer, edge, count, 0, NULL, &before);
    if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->seen, &before);
    for (i = 1; i < count && result == GX_OK; i++) {
        result = gxp_see(blade, layer, edge, count, (double)i, &before, &v);
        if (result == GX_OK) result = gxp_refine(blade, layer, edge, count, &before, &v);
        if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->seen, &v);
        before = v;
    }
    return result == GX_OK ? gxp_list_runs(blade, layer, edge, count) : result;
}

/* >>relations: where a place on the edge lies by the front --------------------------------------------------------- */
/* In: a layer's front, the sheet of its last strips, places of the edge as the layer sees them. Out: which of them are
   ahead of the front, which are behind it in the cut, and which have left that through its side. Changes nothing but
   what it returns. */

/* Shares of an element's size. An advance of less is none. A place behind the front is in the cut if it is no farther
   from its sheet, else the edge has left the cut through its side. */
#define GXP_LEAST_ADVANCE 0.02
#define GXP_CUT_WIDTH     0.15
/* A vertex that has come less far is the old front's. */
#define GXP_STAYED 1e-9
/* A material point on the layer's surface that is no farther from the sheet is on a wall of the cut. */
#define GXP_ON_SHEET 1e-6
/* So far on the other side of the sheet does a track begin, in element sizes. */
#define GXP_CROSSING 0.1
/* Triangles of the last strips that a layer remembers. */
#define GXP_SHEET_TRIANGLES 400u

/* The point of a front nearest to a material point */
static void gxp_near_front(const gxp_front_list *front, const double rest[3], gxp_relation *r, double nearest[3]) {
    double best = HUGE_VAL;
    uint32_t i;
    r->segment = 0;
    r->share = 0;
    memcpy(nearest, front->data[0].rest, 3 * sizeof *nearest);
    for (i = 0; i + 1 < front->count; i++) {
        const gxp_front_vertex *next = &front->data[i + (front->data[i].gap ? 0 : 1)];
        double share, at[3];
        const double square = gxp_onto_segment(rest, front->data[i].rest, next->rest, &share, at);
        if (square >= best) continue;
        best = square;
        r->segment = i;
        r->share = share;
        memcpy(nearest, at, sizeof at);
    }
    r->distance = sqrt(gxp_square_distance(rest, nearest));
}

/* The triangle of a sheet nearest to a material point: the index of its first corner. Returns the distance. */
static double gxp_near_sheet_part(const gxp_points *sheet, const double rest[3], double nearest[3], uint32_t *first) {
    double best = HUGE_VAL;
    uint32_t i;
    *first = 0;
    for (i = 0; i + 2 < sheet->count; i += 3) {
        const double *x = sheet->data + 3 * (size_t)i;
        double at[3], square = 0;
        int k;
        for (k = 0; k < 3; k++) {
            const double below = fmin(x[k], fmin(x[3 + k], x[6 + k])) - rest[k],
                         above = rest[k] - fmax(x[k], fmax(x[3 + k], x[6 + k])), off = fmax(below, above);
            if (off > 0) square += off * off;
        }
        if (square >= best) continue;
        square = gxp_onto_triangle(rest, x, x + 3, x + 6, at);
        if (square >= best) continue;
        best = square;
        *first = i;
        memcpy(nearest, at, sizeof at);
    }
    return sqrt(best);
}

/* The point of a sheet nearest to a material point. Returns the distance. */
static double gxp_near_sheet(const gxp_points *sheet, const double rest[3], double nearest[3]) {
    uint32_t first;
    return gxp_near_sheet_part(sheet, rest, nearest, &first);
}

/* A place behind the front: is it in the cut, has it left that through the side, or is it beside the front, ahead of
   where it turns? */
static gx_result gxp_judge_behind(gx_blade *blade, const gxp_front_vertex *v, gxp_relation *r) {
    const double width = fmax(GXP_CUT_WIDTH * v->size, 2 * blade->tolerance);
    double nearest[3], at[3];
    gxp_relation of_sheet;
    uint32_t cell = GXP_NONE;
    gx_result result;
    if (r->distance <= 2 * blade->tolerance || blade->sheet.count == 0) return GX_OK;
    if (gxp_near_sheet(&blade->sheet, v->rest, nearest) <= width) {
        result = gxp_find_rest_cell(blade->body, nearest, &cell);
        r->ahead = r->doubtful = cell == GXP_NONE; /* the sheet is in the air there: nothing is cut, at least there */
        return result;
    }
    gxp_near_front(&blade->front, nearest, &of_sheet, at);
    r->strays = of_sheet.distance > 2 * width;
    r->ahead = !r->strays;
    return GX_OK;
}

/* The direction in which the front came to the nearest point on it, or to the vertices in the material next to that:
   those in the air have come as the map extended. Returns 0 if the whole front is in the air. */
static int gxp_front_direction(const gxp_front_list *front, const gxp_relation *r, double direction[3]) {
    const gxp_front_vertex *v = front->data;
    uint32_t left = r->segment, right = r->segment + 1;
    double share = r->share;
    int k;
    while (left > 0 && v[left].distance > 0) left--;
    while (right + 1 < front->count && v[right].distance > 0) right++;
    if (v[left].distance > 0) share = 1;
    if (v[right].distance > 0) share = 0;
    for (k = 0; k < 3; k++) direction[k] = (1 - share) * v[left].ahead[k] + share * v[right].ahead[k];
    return !(v[left].distance > 0 && v[right].distance > 0);
}

/* A place in the air behind the front: it stays if it is in the cut. */
static void gxp_judge_air(const gx_blade *blade, const gxp_front_vertex *v, gxp_relation *r) {
    double nearest[3];
    const double distance = gxp_near_sheet(&blade->sheet, v->rest, nearest);
    const int off = distance > GXP_CUT_WIDTH * v->size && distance > 2 * blade->tolerance;
    r->beside = off && !r->ahead;
    r->ahead = off != 0;
}

/* Is a place in the air next to this layer's own cut: between its walls, or before their rims? There the maps of the
   two sides, extended, lead away from each other, and tell nothing of where the edge is by the front. */
static int gxp_is_in_open_cut(const gx_blade *blade, const gxp_front_vertex *v) {
    double nearest[3];
    return v->distance > 0 && v->distance <= v->size &&
           gxp_near_sheet(&blade->sheet, v->foot, nearest) <= GXP_ON_SHEET * v->size;
}

/* Where a place on the edge lies by the front. A front in the air follows the edge: nothing is cut yet. */
static gx_result gxp_relate(gx_blade *blade, const gxp_front_vertex *v, gxp_relation *r) {
    double nearest[3], direction[3], way[3];
    int k;
    gx_result result = GX_OK;
    memset(r, 0, sizeof *r);
    gxp_near_front(&blade->front, v->rest, r, nearest);
    for (k = 0; k < 3; k++) way[k] = v->rest[k] - nearest[k];
    r->ahead = r->distance > 0;
    if (gxp_front_direction(&blade->front, r, direction) && gxp_dot(direction, direction) > 0)
        r->ahead = gxp_dot(direction, way) > 0;
    if (v->distance > 0) {
        if ((!r->ahead || v->walled) && r->distance > 0) gxp_judge_air(blade, v, r);
        if (r->ahead && gxp_is_in_open_cut(blade, v)) r->ahead = 0;
        return GX_OK;
    }
    if (!r->ahead) result = gxp_judge_behind(blade, v, r);
    if (r->distance < GXP_LEAST_ADVANCE * v->size && r->distance < 0.1 * blade->min_advance) r->ahead = 0;
    return result;
}

/* Has an edge that is all in the air come there through its cut? From each vertex of the front in the material, the way
   to the edge begins in the cut's sheet. Otherwise there is material on it that the edge has passed. */
static gx_result gxp_came_back(gx_blade *blade, int *is_back) {
    uint32_t i, seen = 0;
    gx_result result = GX_OK;
    *is_back = 0;
    for (i = 0; i < blade->front.count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &blade->front.data[i];
        gxp_relation r;
        double nearest[3], step[3], place[3];
        uint32_t cell = GXP_NONE;
        int k;
        if (v->distance > 0) continue;
        gxp_near_front(&blade->samples, v->rest, &r, nearest);
        for (k = 0; k < 3; k++) step[k] = nearest[k] - v->rest[k];
        if (!gxp_unit(step, step)) continue;
        for (k = 0; k < 3; k++) place[k] = v->rest[k] + 2 * GXP_CUT_WIDTH * v->size * step[k];
        result = gxp_find_rest_cell(blade->body, place, &cell);
        if (cell == GXP_NONE) continue; /* at the surface: nothing is on the way */
        if (gxp_near_sheet(&blade->sheet, place, nearest) > GXP_CUT_WIDTH * v->size) return result;
        seen += !(gxp_dot(step, v->ahead) > 0.5); /* onwards: the sheet is ahead of its front, where that is in folds */
    }
    *is_back = seen > 0;
    return result;
}

/* Is a place that may be ahead next to one that is in the material, and behind for sure? */
static int gxp_is_beside_behind(const gxp_front_list *samples, const gxp_relation *r, uint32_t index) {
    uint32_t i;
    for (i = index; i > 0 && r[i].doubtful && !samples->data[i - 1].gap;) i--;
    if (!r[i].doubtful && !r[i].ahead && !(samples->data[i].distance > 0)) return 1;
    for (i = index; i + 1 < samples->count && r[i].doubtful && !samples->data[i].gap;) i++;
    return !r[i].doubtful && !r[i].ahead && !(samples->data[i].distance > 0);
}

/* Places in the air beside the sheet, next to one in the material that has left the cut through its side, have left it
   with that one: not those between it and one that is ahead. step: 1, to the next places; -1, to those before */
static void gxp_stray_together(const gxp_front_list *samples, gxp_relation *r, uint32_t index, int step) {
    uint32_t i = index, end;
    for (;;) {
        const int is_end =
            step > 0 ? i + 1 >= samples->count || samples->data[i].gap : i == 0 || samples->data[i - 1].gap;
        if (is_end) break;
        i = step > 0 ? i + 1 : i - 1;
        if (r[i].beside) continue;
        if (r[i].ahead) return;
        break;
    }
    for (end = i, i = index; i != end;) {
        i = step > 0 ? i + 1 : i - 1;
        if (r[i].beside) r[i].ahead = 0;
    }
}

/* The way of a place from the front, of length 1. Returns 0 if it has none. */
static int gxp_way_from_front(const gxp_front_list *front, const gxp_front_vertex *v, double way[3]) {
    gxp_relation r;
    double nearest[3];
    int k;
    gxp_near_front(front, v->rest, &r, nearest);
    for (k = 0; k < 3; k++) way[k] = v->rest[k] - nearest[k];
    return gxp_unit(way, way);
}

/* Ways whose directions differ by less than this cosine says are one. */
#define GXP_SAME_WAY 0.8

/* A place that seems to have left the cut through its side, next to one ahead that has come the same way, is ahead:
   where the edge turns, only the front's direction is another. */
static void gxp_come_along(gxp_relation *r, const gxp_front_list *samples, const gxp_front_list *front, uint32_t from,
                           uint32_t to) {
    double way[3], other[3];
    if (samples->data[from < to ? from : to].gap) return;
    if (!r[to].strays || !r[from].ahead || r[from].beside) return;
    if (!gxp_way_from_front(front, &samples->data[from], other)) return;
    if (!gxp_way_from_front(front, &samples->data[to], way) || !(gxp_dot(way, other) > GXP_SAME_WAY)) return;
    r[to].ahead = 1;
    r[to].strays = 0;
}

/* Judges places by those next to them. */
static void gxp_judge_together(const gxp_front_list *samples, const gxp_front_list *front, gxp_relation *r) {
    uint32_t i;
    for (i = 0; i + 1 < samples->count; i++) gxp_come_along(r, samples, front, i, i + 1);
    for (i = samples->count; i > 1; i--) gxp_come_along(r, samples, front, i - 1, i - 2);
    for (i = 0; i < samples->count; i++) {
        if (!r[i].strays) continue;
        gxp_stray_together(samples, r, i, -1);
        gxp_stray_together(samples, r, i, 1);
    }
}

/* >>fronts: how far the edge has come in a layer ------------------------------------------------------------------- */
/* In: a layer's front and how it sees the edge. Out: the front advanced where the edge is ahead of it, and the strip of
   triangles between the two. Where the edge goes back through its own cut the front stays. Touches the blade's working
   memory. */

/* What the layer's edge does at a move */
typedef struct gxp_advance {
    double most; /* the largest advance, m; of places inside, if there are any */
    int strays;
    int is_back; /* 1: all of the edge is in the air, and has come there through its own cut */
} gxp_advance;

/* The vertex of the front next to the nearest point */
static uint32_t gxp_pin(const gxp_relation *r) { return r->segment + (r->share > 0.5); }

/* Appends the front's own vertices for a run of places that are not ahead: *at is the first vertex not passed yet. */
static gx_result gxp_stay(gx_blade *blade, const gxp_relation *r, uint32_t count, int first, int last, uint32_t *at) {
    uint32_t low = GXP_NONE, high = 0, i;
    gx_result result = GX_OK;
    for (i = 0; i < count; i++) {
        const uint32_t pin = gxp_pin(&r[i]);
        if (pin < low) low = pin;
        if (pin > high) high = pin;
    }
    if (first) low = 0;
    if (last) high = blade->front.count - 1;
    if (low < *at) low = *at;
    for (i = low; i <= high && result == GX_OK; i++)
        result = gxp_push_vertex(blade->body, &blade->advanced, &blade->front.data[i]);
    if (high > *at) *at = high;
    return result;
}

/* Lists in blade.advanced the front as far as the samples have come: these where they are ahead, else its own
   vertices. */
static gx_result gxp_advance_front(gx_blade *blade, gxp_advance *move) {
    const gxp_front_list *samples = &blade->samples;
    gxp_relation *r;
    uint32_t i, j, at = 0;
    int in_air = 1;
    gx_result result = gxp_reserve(&blade->body->config.allocator, &blade->relations, sizeof *r, 0,
                                   &blade->relation_capacity, samples->count);
    memset(move, 0, sizeof *move);
    blade->advanced.count = 0;
    if (result != GX_OK) return result;
    r = blade->relations;
    for (i = 0; i < samples->count; i++) in_air &= samples->data[i].distance > 0;
    if (in_air) result = gxp_came_back(blade, &move->is_back);
    for (i = 0; i < samples->count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &samples->data[i];
        result = gxp_relate(blade, v, &r[i]);
        if (in_air) r[i].ahead = !move->is_back && r[i].distance > 0 && !gxp_is_in_open_cut(blade, v);
    }
    if (result == GX_OK && !in_air) gxp_judge_together(samples, &blade->front, r);
    for (i = 0; i < samples->count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &samples->data[i];
        if (r[i].doubtful && gxp_is_beside_behind(samples, r, i)) r[i].ahead = 0;
        if (r[i].ahead && (in_air || !(v->distance > 0))) move->most = fmax(move->most, r[i].distance);
        move->strays |= r[i].strays;
    }
    for (i = 0; i < samples->count && result == GX_OK; i = j) {
        uint32_t start = blade->advanced.count;
        for (j = i; j < samples->count && r[j].ahead == r[i].ahead; j++) {}
        result = r[i].ahead ? gxp_append_front(blade->body, &blade->advanced, samples->data + i, j - i)
                            : gxp_stay(blade, r + i, j - i, i == 0, j == samples->count, &at);
        if (blade->advanced.count == start) continue;
        blade->advanced.data[start].soft = blade->advanced.data[blade->advanced.count - 1].soft = 0;
        blade->advanced.data[blade->advanced.count - 1].gap = samples->data[j - 1].gap;
    }
    return result;
}

static int gxp_same_rest(const gxp_front_vertex *a, const gxp_front_vertex *b) {
    return a->rest[0] == b->rest[0] && a->rest[1] == b->rest[1] && a->rest[2] == b->rest[2];
}

/* The next corner of a front after a vertex, or count */
static uint32_t gxp_next_corner(const gxp_front_list *front, uint32_t i) {
    for (i++; i < front->count && front->data[i].soft; i++) {}
    return i;
}

/* The first gap of a front from a vertex on that overlaps a gap of another one, by places on the edge, or count */
static uint32_t gxp_shared_gap(const gxp_front_list *front, uint32_t i, const gxp_front_list *other, uint32_t from,
                               uint32_t *of_other) {
    uint32_t j;
    for (; i + 1 < front->count; i++) {
        if (!front->data[i].gap) continue;
        for (j = from; j + 1 < other->count; j++)
            if (other->data[j].gap && other->data[j].along < front->data[i + 1].along &&
                front->data[i].along < other->data[j + 1].along) {
                *of_other = j;
                return i;
            }
    }
    *of_other = other->count - 1;
    return front->count - 1;
}

/* Appends to blade.strip the triangles between two vertices of a front and two of another one: the shorter diagonal
   comes first. Vertices that both have make no triangle. */
static gx_result gxp_zip_runs(gx_blade *blade, const gxp_front_list *from, uint32_t i, uint32_t i_end,
                              const gxp_front_list *to, uint32_t j, uint32_t j_end) {
    uint32_t k, next_i = gxp_next_corner(from, i), next_j = gxp_next_corner(to, j);
    gx_result result = GX_OK;
    while ((next_i <= i_end || next_j <= j_end) && result == GX_OK) {
        const gxp_front_vertex *corner[3];
        const int by_from =
            next_i <= i_end && (next_j > j_end || gxp_square_distance(from->data[next_i].rest, to->data[j].rest) <=
                                                      gxp_square_distance(from->data[i].rest, to->data[next_j].rest));
        corner[0] = &from->data[i];
        corner[1] = by_from ? &from->data[next_i] : &to->data[next_j];
        corner[2] = &to->data[j];
        if (by_from) {
            i = next_i;
            next_i = gxp_next_corner(from, i);
        } else {
            j = next_j;
            next_j = gxp_next_corner(to, j);
        }
        if (gxp_same_rest(corner[0], corner[1]) || gxp_same_rest(corner[1], corner[2]) ||
            gxp_same_rest(corner[0], corner[2]))
            continue;
        for (k = 0; k < 3 && result == GX_OK; k++) result = gxp_push_vertex(blade->body, &blade->strip, corner[k]);
    }
    return result;
}

/* Lists in blade.strip the triangles between two fronts. A gap that both have stays open. */
static gx_result gxp_zip(gx_blade *blade, const gxp_front_list *from, const gxp_front_list *to) {
    uint32_t i = 0, j = 0, i_end, j_end;
    gx_result result = GX_OK;
    blade->strip.count = 0;
    while (i < from->count && j < to->count && result == GX_OK) {
        i_end = gxp_shared_gap(from, i, to, j, &j_end);
        result = gxp_zip_runs(blade, from, i, i_end, to, j, j_end);
        i = i_end + 1;
        j = j_end + 1;
    }
    return result;
}

/* The largest distance of the edge's path since the front was cut from the strip, or from the front where that stays */
static double gxp_bend(const gx_blade *blade) {
    double most = 0;
    uint32_t i, t;
    for (i = 0; i < blade->path.count && blade->strip.count > 0; i++) {
        const double *x = blade->path.data + 3 * (size_t)i;
        double best, at[3];
        gxp_relation r;
        gxp_near_front(&blade->front, x, &r, at);
        best = r.distance * r.distance;
        for (t = 0; t < blade->strip.count; t += 3)
            best = fmin(best, gxp_onto_triangle(x, blade->strip.data[t].rest, blade->strip.data[t + 1].rest,
                                                blade->strip.data[t + 2].rest, at));
        most = fmax(most, best);
    }
    return sqrt(most);
}

static int gxp_has_direction(const gxp_front_vertex *v) { return gxp_dot(v->ahead, v->ahead) > 0; }

/* The direction of a front at the point of it that is nearest to a vertex. Returns 0 if it has none there. */
static int gxp_old_direction(const gxp_front_list *from, const gxp_relation *r, double ahead[3]) {
    const gxp_front_vertex *v = &from->data[r->segment];
    int k;
    if (!gxp_has_direction(&v[0]) && !gxp_has_direction(&v[1])) return 0;
    for (k = 0; k < 3; k++) ahead[k] = (1 - r->share) * v[0].ahead[k] + r->share * v[1].ahead[k];
    return 1;
}

/* Vertices without a direction take that of the nearest one that has. */
static void gxp_spread_directions(gxp_front_list *to) {
    uint32_t i, off;
    for (i = 0; i < to->count; i++)
        for (off = 1; off < to->count && !gxp_has_direction(&to->data[i]); off++) {
            if (i >= off) memcpy(to->data[i].ahead, to->data[i - off].ahead, sizeof to->data[i].ahead);
            if (!gxp_has_direction(&to->data[i]) && i + off < to->count)
                memcpy(to->data[i].ahead, to->data[i + off].ahead, sizeof to->data[i].ahead);
        }
}

/* The direction in which each vertex of the new front has come from the old one. Those that have stayed keep theirs.
   Those that have hardly come take their neighbours', which have: where the edge turns, the old front's is another. */
static void gxp_set_directions(const gxp_front_list *from, gxp_front_list *to) {
    uint32_t i, come = 0;
    int k;
    for (i = 0; i < to->count; i++) {
        gxp_front_vertex *v = &to->data[i];
        gxp_relation r;
        double nearest[3], way[3];
        gxp_near_front(from, v->rest, &r, nearest);
        for (k = 0; k < 3; k++) way[k] = v->rest[k] - nearest[k];
        if (gxp_unit(way, way) && r.distance > GXP_LEAST_ADVANCE * v->size) {
            memcpy(v->ahead, way, sizeof way);
            come++;
        } else if (r.distance > GXP_STAYED * v->size || !gxp_old_direction(from, &r, v->ahead))
            v->ahead[0] = v->ahead[1] = v->ahead[2] = 0;
    }
    for (i = 0; i < to->count && come == 0; i++) {
        gxp_relation r;
        double nearest[3];
        gxp_near_front(from, to->data[i].rest, &r, nearest);
        gxp_old_direction(from, &r, to->data[i].ahead);
    }
    gxp_spread_directions(to);
}

/* Cuts the strip up to a new front, which becomes the layer's. */
static gx_result gxp_cut_strip(gx_blade *blade, gxp_front_list *to, gx_blade_report *report) {
    gx_body *body = blade->body;
    const uint32_t room = 3 * GXP_SHEET_TRIANGLES;
    uint32_t i;
    gx_result result = gxp_append_front(body, &blade->cut, blade->strip.data, blade->strip.count);
    report->deviation = fmax(report->deviation, gxp_bend(blade));
    for (i = 0; i < blade->strip.count && result == GX_OK; i++)
        result = gxp_push_point(body, &blade->sheet, blade->strip.data[i].rest);
    if (result != GX_OK) return result;
    if (blade->sheet.count > room) {
        memmove(blade->sheet.data, blade->sheet.data + 3 * (size_t)(blade->sheet.count - room),
                3 * room * sizeof *blade->sheet.data);
        blade->sheet.count = room;
    }
    gxp_set_directions(&blade->front, to);
    blade->path.count = blade->latest.count = 0;
    return gxp_copy_front(body, &blade->front, to);
}

/* Is the edge farther than an element from the layer? */
static int gxp_is_away(const gx_blade *blade) {
    uint32_t i;
    for (i = 0; i < blade->samples.count; i++)
        if (!(blade->samples.data[i].distance > blade->samples.data[i].size)) return 0;
    return 1;
}

/* Cuts what waits, and advances the front from there. */
static gx_result gxp_cut_waiting(gx_blade *blade, gxp_advance *move, gx_blade_report *report) {
    gx_result result = gxp_copy_front(blade->body, &blade->advanced, &blade->latest);
    if (result == GX_OK) result = gxp_zip(blade, &blade->front, &blade->advanced);
    if (result == GX_OK) result = gxp_cut_strip(blade, &blade->advanced, report);
    return result == GX_OK ? gxp_advance_front(blade, move) : result;
}

/* The edge has come back out of its cut: what waits is cut, and the front begins anew in the air. */
static gx_result gxp_begin_outside(gx_blade *blade, gxp_advance *move, gx_blade_report *report) {
    const gx_result result = blade->latest.count > 0 ? gxp_cut_waiting(blade, move, report) : GX_OK;
    if (result != GX_OK) return result;
    blade->path.count = blade->latest.count = blade->sheet.count = 0;
    return gxp_copy_front(blade->body, &blade->front, &blade->samples);
}

/* Moves a point of a sheet away from its rims, if it is next to one: to where the sheet goes on on all sides. */
static void gxp_move_inward(const gxp_points *sheet, uint32_t first, double inward, double nearest[3]) {
    static const double turns[8][2] = {{1, 0},  {0.7071, 0.7071},   {0, 1},  {-0.7071, 0.7071},
                                       {-1, 0}, {-0.7071, -0.7071}, {0, -1}, {0.7071, -0.7071}};
    const double *x = sheet->data + 3 * (size_t)first;
    double u[3], v[3], normal[3], outward[3] = {0, 0, 0}, place[3], at[3];
    int i, k;
    for (k = 0; k < 3; k++) {
        u[k] = x[3 + k] - x[k];
        v[k] = x[6 + k] - x[k];
    }
    gxp_cross(normal, u, v);
    if (!gxp_unit(normal, normal) || !gxp_unit(u, u)) return;
    gxp_cross(v, normal, u);
    for (i = 0; i < 8; i++) {
        for (k = 0; k < 3; k++) place[k] = nearest[k] + inward * (turns[i][0] * u[k] + turns[i][1] * v[k]);
        if (gxp_near_sheet(sheet, place, at) <= 0.5 * inward) continue;
        for (k = 0; k < 3; k++) outward[k] += turns[i][0] * u[k] + turns[i][1] * v[k];
    }
    if (gxp_dot(outward, outward) < 0.25 || !gxp_unit(outward, outward)) return;
    for (k = 0; k < 3; k++) place[k] = nearest[k] - inward * outward[k];
    gxp_near_sheet(sheet, place, nearest);
}

/* The place on the sheet at which the edge has left it: the nearest one, but for the rims of the sheet, which a track
   would miss. way: from there to where the edge is. */
static void gxp_leave_sheet(const gxp_points *sheet, const double rest[3], double inward, double nearest[3],
                            double way[3]) {
    uint32_t first;
    int k;
    gxp_near_sheet_part(sheet, rest, nearest, &first);
    gxp_move_inward(sheet, first, inward, nearest);
    for (k = 0; k < 3; k++) way[k] = rest[k] - nearest[k];
}

/* A place of a track begins on the other side of the sheet from where the edge has left it. side: the way that the
   farthest place has left */
static void gxp_cross_sheet(const gx_blade *blade, const double side[3], gxp_front_vertex *v) {
    double nearest[3], way[3];
    const double across = fmax(2 * blade->tolerance, GXP_CROSSING * v->size);
    int k;
    gxp_leave_sheet(&blade->sheet, v->rest, across, nearest, way);
    memcpy(v->ahead, side, sizeof v->ahead);
    if (gxp_dot(way, way) > 4 * blade->tolerance * blade->tolerance) gxp_unit(way, v->ahead);
    for (k = 0; k < 3; k++) v->rest[k] = nearest[k] - across * v->ahead[k];
}

/* Lists in blade.crossings where a track would begin at each of the samples. Places still in the cut cross the sheet
   the way that the farthest one has left. */
static gx_result gxp_list_crossings(gx_blade *blade) {
    const gxp_front_list *samples = &blade->samples;
    double most = 0, side[3] = {0, 0, 0};
    uint32_t i;
    gx_result result = GX_OK;
    for (i = 0; i < samples->count; i++) {
        const gxp_front_vertex *v = &samples->data[i];
        double nearest[3], way[3];
        const double distance = gxp_near_sheet(&blade->sheet, v->rest, nearest);
        if (v->distance > 0 || !(distance > most)) continue;
        gxp_leave_sheet(&blade->sheet, v->rest, GXP_CROSSING * v->size, nearest, way);
        if (gxp_unit(way, side)) most = distance;
    }
    blade->crossings.count = 0;
    for (i = 0; i < samples->count && result == GX_OK; i++) {
        gxp_front_vertex v = samples->data[i];
        gxp_cross_sheet(blade, side, &v);
        v.soft = 0;
        result = gxp_push_vertex(blade->body, &blade->crossings, &v);
    }
    return result;
}

/* Appends the crossing of a sample to blade.latest, unless it is not next to one that is ahead. */
static gx_result gxp_push_crossing(gx_blade *blade, uint32_t index) {
    gxp_front_vertex v = blade->crossings.data[index];
    v.gap = 0;
    return blade->relations[index].ahead ? GX_OK : gxp_push_vertex(blade->body, &blade->latest, &v);
}

/* Inserts the crossings next to places that are ahead into blade.advanced: the strip up to the front goes on to where
   the track begins. */
static gx_result gxp_turn_front(gx_blade *blade) {
    const gxp_front_list *samples = &blade->samples;
    uint32_t i, n = 0;
    gx_result result = GX_OK;
    blade->latest.count = 0;
    for (i = 0; i < samples->count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &samples->data[i];
        if (!blade->relations[i].ahead) continue;
        while (!gxp_same_rest(&blade->advanced.data[n], v) && result == GX_OK)
            result = gxp_push_vertex(blade->body, &blade->latest, &blade->advanced.data[n++]);
        if (i > 0 && !v[-1].gap && result == GX_OK) result = gxp_push_crossing(blade, i - 1);
        if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->latest, &blade->advanced.data[n++]);
        if (i + 1 < samples->count && !v->gap && result == GX_OK) result = gxp_push_crossing(blade, i + 1);
    }
    if (result == GX_OK)
        result = gxp_append_front(blade->body, &blade->latest, blade->advanced.data + n, blade->advanced.count - n);
    if (result == GX_OK) result = gxp_copy_front(blade->body, &blade->advanced, &blade->latest);
    blade->latest.count = 0;
    return result;
}

/* The edge has left its cut through the side: the front begins anew there, a little on the other side of the sheet, so
   that the next strip crosses it. Places that were ahead are on the sheet's rim, and the front goes on there. */
static gx_result gxp_begin_track(gx_blade *blade) {
    const gxp_relation *r = blade->relations;
    const uint32_t count = blade->samples.count;
    uint32_t i;
    gx_result result = GX_OK;
    blade->front.count = blade->path.count = blade->latest.count = 0;
    for (i = 0; i < count && result == GX_OK; i++) {
        gxp_front_vertex v = r[i].ahead ? blade->samples.data[i] : blade->crossings.data[i];
        if (i == 0 || !r[i - 1].ahead || i + 1 == count || !r[i + 1].ahead) v.soft = 0;
        result = gxp_push_vertex(blade->body, &blade->front, &v);
    }
    return result;
}

/* Remembers where the edge is, if it has come far enough since it was remembered last. */
static gx_result gxp_note_path(gx_blade *blade) {
    uint32_t i;
    double most = 0;
    gx_result result = GX_OK;
    for (i = 0; i < blade->advanced.count && blade->latest.count > 0; i++) {
        gxp_relation r;
        double nearest[3];
        gxp_near_front(&blade->latest, blade->advanced.data[i].rest, &r, nearest);
        most = fmax(most, r.distance);
    }
    if (blade->latest.count == 0 || most > 0.125 * blade->min_advance)
        for (i = 0; i < blade->advanced.count && result == GX_OK; i++)
            if (!(blade->advanced.data[i].distance > 0))
                result = gxp_push_point(blade->body, &blade->path, blade->advanced.data[i].rest);
    return result == GX_OK ? gxp_copy_front(blade->body, &blade->latest, &blade->advanced) : result;
}

/* Are front and edge farther than an element from the layer, and nothing waits? */
static int gxp_has_left(const gx_blade *blade) {
    uint32_t i;
    if (blade->latest.count > 0) return 0;
    for (i = 0; i < blade->front.count; i++)
        if (!(blade->front.data[i].distance > blade->front.data[i].size)) return 0;
    return gxp_is_away(blade);
}

/* The edge has left the cut through its side: cuts as far as the front has come, and begins a track. */
static gx_result gxp_leave_cut(gx_blade *blade, gxp_advance *move, gx_blade_report *report) {
    gx_result result = GX_OK;
    if (blade->latest.count > 0) result = gxp_cut_waiting(blade, move, report);
    if (result != GX_OK || !move->strays) return result;
    result = gxp_list_crossings(blade);
    if (result == GX_OK) result = gxp_turn_front(blade);
    if (result == GX_OK) result = gxp_zip(blade, &blade->front, &blade->advanced);
    if (result == GX_OK) result = gxp_cut_strip(blade, &blade->advanced, report);
    if (result == GX_OK) result = gxp_begin_track(blade);
    return result == GX_OK ? gxp_advance_front(blade, move) : result;
}

/* Advances the front of the layer at work to the samples: cuts what must be cut, and lets the rest wait. finish: cuts
   all. A front that has left the layer is no more. */
static gx_result gxp_follow_edge(gx_blade *blade, int finish, gx_blade_report *report) {
    gxp_advance move;
    gx_result result = gxp_advance_front(blade, &move);
    if (result == GX_OK && gxp_has_left(blade)) {
        blade->front.count = 0;
        return GX_OK;
    }
    if (result == GX_OK && move.is_back) return gxp_is_away(blade) ? gxp_begin_outside(blade, &move, report) : GX_OK;
    if (result == GX_OK && move.strays && !finish) result = gxp_leave_cut(blade, &move, report);
    if (result != GX_OK || !(move.most > 0)) return result;
    result = gxp_zip(blade, &blade->front, &blade->advanced);
    if (result == GX_OK && blade->latest.count > 0 && (gxp_is_away(blade) || gxp_bend(blade) > blade->tolerance)) {
        result = gxp_cut_waiting(blade, &move, report);
        if (result == GX_OK) result = gxp_zip(blade, &blade->front, &blade->advanced);
    }
    if (result != GX_OK || !(move.most > 0)) return result;
    if (finish || move.most >= blade->min_advance) return gxp_cut_strip(blade, &blade->advanced, report);
    blade->advance = fmax(blade->advance, move.most);
    return gxp_note_path(blade);
}

/* A strip reaches cells that are within this share of their size of it, as the body lies now: where strip and layer
   are far from each other in space, none of it is meant for them. */
#define GXP_STRIP_REACH 0.25

/* Is the cell within reach of a strip? */
static int gxp_is_in_reach(const gxp_close_cell *c, const gxp_plate *plates, uint32_t triangles) {
    uint32_t t;
    for (t = 0; t < triangles; t++)
        if (gxp_is_near_plate(&plates[t], c->middle, c->radius + GXP_STRIP_REACH * c->size)) return 1;
    return 0;
}

/* Lists the slots of a layer that the strips of blade.cut may cut. old: only those that belonged to this layer at the
   last move; GXP_NONE: all. */
static gx_result gxp_list_scope(gx_blade *blade, uint32_t layer, uint32_t old) {
    const gxp_vicinity *near = &blade->near;
    const uint32_t triangles = blade->cut.count / 3;
    uint32_t i, k;
    gx_result result = gxp_plates_room(blade, triangles);
    for (i = 0; i < triangles && result == GX_OK; i++) {
        double x[3][3];
        for (k = 0; k < 3 && result == GX_OK; k++)
            result = gxp_front_position(blade, layer, 0, &blade->cut.data[3 * i + k], x[k]);
        if (result == GX_OK) gxp_set_plate(&blade->plates[i], x[0], x[1], x[2]);
    }
    for (i = near->layer_start.data[layer]; i < near->layer_start.data[layer + 1] && result == GX_OK; i++) {
        const gxp_close_cell *c = &near->cells[GXP_SECOND(near->order.data[i])];
        if (old != GXP_NONE && gxp_old_layer(blade, c->cell) != old) continue;
        if (gxp_is_in_reach(c, blade->plates, triangles))
            result = gxp_push(blade->body, &blade->scope, blade->body->cells.slot[c->cell]);
    }
    return result;
}

/* Adds the strips of the layer at work to those of the move. */
static gx_result gxp_add_surface(gx_blade *blade, uint32_t layer, uint32_t old) {
    gx_body *body = blade->body;
    const uint32_t before = blade->scope.count;
    uint32_t i;
    gx_result result = blade->cut.count > 0 ? gxp_list_scope(blade, layer, old) : GX_OK;
    if (blade->scope.count == before) blade->cut.count = 0;
    if (result != GX_OK || blade->scope.count == before) return result;
    result = gxp_push(body, &blade->surface_starts, before);
    if (result == GX_OK) result = gxp_push(body, &blade->surface_starts, blade->corners.count);
    for (i = 0; i < blade->cut.count && result == GX_OK; i++)
        result = gxp_push_point(body, &blade->corners, blade->cut.data[i].rest);
    blade->cut.count = 0;
    return result;
}

/* >>glances: moves that are left out ------------------------------------------------------------------------------- */
/* In: a blade's edge, the body as it is now, beads: places on the edge that follow the material. Out: whether a move
 * changes so little that it need not be worked out: then only edge and body are remembered. Touches the beads,
 * copies.struck and the blade's working memory.
 *
 * The strip between two moves that are worked out is straight. A move between them may be left out if the edge is on
 * that strip, to a quarter of the tolerance: each bead has come straight from where it was, so that no place between
 * is farther ahead. When a bead has not, the last move that was left out is worked out first, with the body as it was
 * then (copies.struck, which cuts keep up to date). In all, edge and body move by less than an element while moves are
 * left out, which one move may do at once. So a blade that is moved more often does what it would do if moved less
 * often, but never less often than its path bends.
 *
 * One blade of a body at a time leaves out moves: the others' places of the body are not remembered. */

/* Shares. Beads are places within the first of an element's size of the layer. A bead is off its way by less than the
   second of the tolerance. Edge and copies move by less than the third of the mean size, in all. A bead comes less far
   than the fourth of the least advance that is cut, and of half the mean size; and no move is worked out because of
   what waits before the edge has come as far as the last of these. */
#define GXP_BEAD_REACH   0.5
#define GXP_BEAD_OFF     0.25
#define GXP_GLANCE_ROOM  0.75
#define GXP_BEAD_COURSE  1.0
#define GXP_LEAST_GLANCE 0.125

/* A bead goes through so many cells at most at a move. One that is off its cell by less than the second, in weights,
   stays there. */
#define GXP_BEAD_FACES 8
#define GXP_BEAD_TOUCH 1e-9

typedef enum gxp_verdict {                      /* what a move is */
                           GXP_GLANCE_AWAY,     /* nothing is known of it */
                           GXP_GLANCE_BENT,     /* a bead has not come straight, or too far */
                           GXP_GLANCE_STRAIGHT, /* all have, but the move is to be worked out */
                           GXP_GLANCE_LITTLE    /* it may be left out */
} gxp_verdict;

/* The cell across a face of a cell: one that has the copies of the face, GXP_NONE: there is none */
static uint32_t gxp_cell_across(const gx_body *body, uint32_t cell, uint32_t face) {
    const gxp_cell *row = &body->cells.data[cell];
    uint32_t next = gxp_neighbour(body, row->element, face), i, k;
    for (; next != GXP_NONE; next = body->cells.data[next].next) {
        const uint32_t *own = body->cells.data[next].copies;
        uint32_t shared = 0;
        for (i = 0; i < 4; i++)
            for (k = 0; k < 4; k++) shared += i != face && own[k] == row->copies[i];
        if (body->cells.data[next].kept && shared == 3) break;
    }
    return next;
}

/* The material point of a place in space, by the map of a cell that is walked to from *cell, which is next to it */
static void gxp_follow_place(const gx_body *body, const double x[3], uint32_t *cell, double rest[3]) {
    static const double origin[3] = {0, 0, 0};
    double corners[4][3], weights[4];
    uint32_t next = *cell, face, k;
    int faces;
    for (faces = 0; next != GXP_NONE && faces < GXP_BEAD_FACES; faces++) {
        *cell = next;
        gxp_place_by_map(body, &body->cells.data[next], x, weights);
        for (face = 0, k = 1; k < 4; k++)
            if (weights[k] < weights[face]) face = k;
        next = weights[face] < -GXP_BEAD_TOUCH ? gxp_cell_across(body, next, face) : GXP_NONE;
    }
    gxp_cell_corners(body, &body->cells.data[*cell], 0, origin, corners);
    gxp_weigh(corners, weights, rest);
}

/* A cell of the layer at work that has the element of a place, GXP_NONE: there is none */
static gx_result gxp_bead_cell(gx_blade *blade, uint32_t layer, const gxp_front_vertex *v, uint32_t *found) {
    gx_body *body = blade->body;
    uint32_t cell, holder = GXP_NONE;
    gx_result result = GX_OK;
    *found = GXP_NONE;
    if (body->cells.data[v->element].next != GXP_NONE) result = gxp_cell_at(body, v->element, v->extended, &holder);
    for (cell = v->element; cell != GXP_NONE; cell = body->cells.data[cell].next)
        if (body->cells.data[cell].kept && gxp_layer_of(&blade->near, cell) == layer &&
            (*found == GXP_NONE || cell == holder))
            *found = cell;
    return result;
}

/* Makes beads of the places of blade.seen in the layer and next to it. */
static gx_result gxp_list_beads(gx_blade *blade, uint32_t layer) {
    gx_body *body = blade->body;
    gxp_bead_list *beads = &blade->then.glance.beads;
    uint32_t i;
    gx_result result = gxp_reserve(&body->config.allocator, &beads->data, sizeof *beads->data, beads->count,
                                   &beads->capacity, blade->seen.count);
    for (i = 0; i < blade->seen.count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &blade->seen.data[i];
        gxp_bead bead;
        memset(&bead, 0, sizeof bead);
        if (v->distance > GXP_BEAD_REACH * v->size) continue;
        result = gxp_bead_cell(blade, layer, v, &bead.cell);
        if (bead.cell == GXP_NONE) continue;
        bead.along = v->along;
        gxp_follow_place(body, v->position, &bead.cell, bead.rest);
        beads->data[beads->count++] = bead;
    }
    return result;
}

static double gxp_length(const double a[3]) { return sqrt(gxp_dot(a, a)); }

/* Two disks of directions: a smaller one that is in both. Returns 0 if there is none. way: from the first's middle to
   the second's */
static int gxp_narrow_course(gxp_bead *bead, const double way[3], double radius) {
    const double off = gxp_length(way);
    double share, common;
    int k;
    if (off + bead->radius <= radius) return 1;
    share = 1;
    common = radius;
    if (!(off + radius <= bead->radius)) {
        common = 0.5 * (bead->radius + radius - off);
        if (!(common > 0)) return 0;
        share = 0.5 * (off - radius + bead->radius) / off;
    }
    for (k = 0; k < 3; k++) bead->slope[k] += share * way[k];
    bead->radius = common;
    return 1;
}

/* A bead comes to a material point. Has it come straight, to `off` at most? */
static int gxp_comes_straight(gxp_bead *bead, const double rest[3], double off) {
    double way[3], way_off[3], along;
    int k;
    for (k = 0; k < 3; k++) way[k] = rest[k] - bead->rest[k];
    if (!(bead->farthest > 0)) {
        const double length = gxp_length(way);
        if (length <= off) return 1;
        for (k = 0; k < 3; k++) bead->axis[k] = way[k] / length;
        bead->radius = off / length;
        bead->farthest = length;
        return gxp_is_finite(length);
    }
    along = gxp_dot(way, bead->axis);
    if (!(along >= bead->farthest - off && along > 0)) return 0;
    for (k = 0; k < 3; k++) way_off[k] = way[k] / along - bead->axis[k] - bead->slope[k];
    if (!(gxp_length(way_off) <= bead->radius)) return 0;
    bead->farthest = fmax(bead->farthest, along);
    return gxp_narrow_course(bead, way_off, off / along);
}

/* Lists in blade.followed where the beads come to. */
static gx_result gxp_follow_beads(gx_blade *blade, const double *edge, uint32_t count, gxp_verdict *verdict) {
    gx_body *body = blade->body;
    const gxp_glance *glance = &blade->now.glance;
    gxp_bead_list *to = &blade->followed;
    uint32_t i;
    const gx_result result =
        gxp_reserve(&body->config.allocator, &to->data, sizeof *to->data, 0, &to->capacity, glance->beads.count);
    if (result != GX_OK) return result;
    to->count = glance->beads.count;
    for (i = 0; i < to->count && *verdict != GXP_GLANCE_BENT; i++) {
        double x[3], rest[3], square;
        to->data[i] = glance->beads.data[i];
        gxp_edge_position(edge, count, to->data[i].along, x);
        gxp_follow_place(body, x, &to->data[i].cell, rest);
        square = gxp_square_distance(rest, to->data[i].rest);
        if (!(square <= glance->course * glance->course)) *verdict = GXP_GLANCE_STRAIGHT;
        if (!(square <= 4 * glance->course * glance->course) ||
            !gxp_comes_straight(&to->data[i], rest, GXP_BEAD_OFF * blade->tolerance))
            *verdict = GXP_GLANCE_BENT;
    }
    return GX_OK;
}

/* How far a copy has moved since the last move, m; HUGE_VAL if that is not known. Sums show what is not finite. */
static double gxp_measure_motion(const gx_body *body) {
    const double *u = body->copies.displacement, *struck = body->copies.struck;
    double most = 0, sum = 0;
    uint32_t i;
    for (i = 0; i < body->copies.count; i++, u += 3, struck += 3) {
        const double square = gxp_square_distance(u, struck);
        most = gxp_more(square, most);
        sum += square;
    }
    return gxp_is_finite(sum) ? sqrt(most) : HUGE_VAL;
}

/* How far a point of the edge has come in space since a move was worked out, m */
static double gxp_measure_edge(const gx_blade *blade, const double *edge, uint32_t count) {
    double most = 0;
    uint32_t i;
    for (i = 0; i < count; i++)
        most = fmax(most, gxp_square_distance(edge + 3 * (size_t)i, blade->now.edge.data + 3 * (size_t)i));
    return sqrt(most);
}

/* Judges a move: may it be left out? *motion: how far copies have moved since the last one */
static gx_result gxp_judge_move(gx_blade *blade, const double *edge, uint32_t count, double *motion,
                                gxp_verdict *verdict) {
    const gxp_glance *glance = &blade->now.glance;
    double way;
    *verdict = GXP_GLANCE_AWAY;
    if (!glance->ready || glance->cut != blade->body->cuts.hash) return GX_OK;
    *motion = gxp_measure_motion(blade->body);
    way = glance->travelled + *motion + gxp_measure_edge(blade, edge, count);
    *verdict = way <= glance->room ? GXP_GLANCE_LITTLE : GXP_GLANCE_STRAIGHT;
    if (!(way <= 2 * blade->step)) *verdict = GXP_GLANCE_BENT;
    return gxp_follow_beads(blade, edge, count, verdict);
}

static void gxp_note_struck(gx_body *body) {
    if (body->copies.count > 0)
        memcpy(body->copies.struck, body->copies.displacement, 3 * (size_t)body->copies.count * sizeof(double));
}

/* Leaves out a move: remembers where edge, beads and body are. */
static gx_result gxp_leave_out(gx_blade *blade, const double *edge, uint32_t count, double motion) {
    gxp_glance *glance = &blade->now.glance;
    const gxp_bead_list beads = glance->beads;
    const gx_result result = gxp_reserve(&blade->body->config.allocator, &glance->edge.data,
                                         3 * sizeof *glance->edge.data, 0, &glance->edge.capacity, count);
    if (result != GX_OK) return result;
    memcpy(glance->edge.data, edge, 3 * (size_t)count * sizeof *edge);
    glance->edge.count = count;
    glance->travelled += motion;
    glance->beads = blade->followed;
    blade->followed = beads;
    gxp_note_struck(blade->body);
    return GX_OK;
}

static void gxp_end_glances(gxp_glance *glance) {
    glance->ready = 0;
    glance->edge.count = glance->beads.count = 0;
    glance->travelled = glance->room = glance->course = 0;
    glance->cut = 0;
}

/* May the blade leave out moves from here on? No other one of the body does. */
static int gxp_is_free(const gx_blade *blade) {
    const gx_blade *other;
    for (other = blade->body->blades; other != NULL; other = other->next)
        if (other != blade && other->now.glance.ready) return 0;
    return 1;
}

/* Makes copies.struck, unless it is there. */
static gx_result gxp_start_struck(gx_body *body) {
    return body->copies.struck != NULL
             ? GX_OK
             : gxp_grow_column(body, &gxp_copy_columns[GXP_STRUCK_COLUMN], 0, body->copies.count);
}

/* After a move that is worked out the next ones may be left out, from gxp_be_ready on. */
static gx_result gxp_get_ready(gx_blade *blade) {
    gxp_glance *glance = &blade->then.glance;
    const double least = GXP_LEAST_GLANCE * fmin(blade->min_advance, 0.5 * blade->step),
                 most = GXP_BEAD_COURSE * fmin(blade->min_advance, 0.5 * blade->step);
    const gx_result result = gxp_start_struck(blade->body);
    glance->edge.count = 0;
    if (result != GX_OK) return result;
    glance->ready = 1;
    glance->travelled = 0;
    glance->room = fmax(fmin(blade->room, GXP_GLANCE_ROOM * blade->step), least);
    glance->course = fmin(fmax(blade->min_advance - blade->advance, least), most);
    glance->cut = blade->body->cuts.hash;
    return GX_OK;
}

/* Cells have other names after a cut: until then beads have those of their elements in place of them. */
static void gxp_note_bead_elements(gx_blade *blade) {
    const gxp_bead_list *beads = &blade->then.glance.beads;
    uint32_t i;
    for (i = 0; i < beads->count; i++) beads->data[i].cell = blade->body->cells.data[beads->data[i].cell].element;
}

/* After the cut: the cell of a bead is that which has its place, or else any of its element's. */
static void gxp_place_beads(gx_blade *blade) {
    gx_body *body = blade->body;
    gxp_bead_list *beads = &blade->then.glance.beads;
    uint32_t i, n = 0;
    for (i = 0; i < beads->count; i++) {
        gxp_bead *bead = &beads->data[n];
        uint32_t cell, holder = GXP_NONE;
        *bead = beads->data[i];
        cell = bead->cell;
        if (body->cells.data[cell].next == GXP_NONE || gxp_cell_at(body, cell, bead->rest, &holder) != GX_OK)
            holder = GXP_NONE;
        while (holder == GXP_NONE && cell != GXP_NONE && !body->cells.data[cell].kept)
            cell = body->cells.data[cell].next;
        bead->cell = holder != GXP_NONE ? holder : cell;
        n += bead->cell != GXP_NONE;
    }
    beads->count = n;
}

/* The blade is ready, with the body as it is now. */
static void gxp_be_ready(gx_blade *blade) {
    blade->then.glance.cut = blade->body->cuts.hash;
    gxp_note_struck(blade->body);
}

/* Leaves out a move if that may be. */
static gx_result gxp_try_leaving_out(gx_blade *blade, const double *edge, uint32_t count, int *left_out) {
    double motion = 0;
    gxp_verdict verdict = GXP_GLANCE_AWAY;
    const gx_result result = gxp_judge_move(blade, edge, count, &motion, &verdict);
    *left_out = result == GX_OK && verdict == GXP_GLANCE_LITTLE;
    return *left_out ? gxp_leave_out(blade, edge, count, motion) : result;
}

/* Copies change places between where they are and where they were at the last move. */
static void gxp_swap_struck(gx_body *body) {
    double *u = body->copies.displacement, *struck = body->copies.struck;
    size_t i;
    for (i = 0; i < 3 * (size_t)body->copies.count; i++) {
        const double x = u[i];
        u[i] = struck[i];
        struck[i] = x;
    }
}

/* Where the last move left the edge */
static const gxp_points *gxp_last_edge(const gx_blade *blade) {
    return blade->now.glance.edge.count > 0 ? &blade->now.glance.edge : &blade->now.edge;
}

/* >>strokes: what a blade remembers from move to move -------------------------------------------------------------- */
/* In: the layers of the last move, those of now. Out: each new layer with the front of the old ones that flow into it.
   Touches the blade's working memory and the state that the move makes. */

/* Lists in blade.owners the old layers that flow into a new one. */
static gx_result gxp_find_owners(gx_blade *blade, uint32_t layer) {
    const gxp_vicinity *near = &blade->near;
    uint32_t i, last = GXP_NONE;
    gx_result result = GX_OK;
    blade->owners.count = 0;
    for (i = near->layer_start.data[layer]; i < near->layer_start.data[layer + 1] && result == GX_OK; i++) {
        const uint32_t old = gxp_old_layer(blade, near->cells[GXP_SECOND(near->order.data[i])].cell);
        if (old == GXP_NONE || old == last) continue;
        last = old;
        if (blade->now.layers.data[old].front_count == 0) continue;
        if (!gxp_contains(&blade->owners, old)) result = gxp_push(blade->body, &blade->owners, old);
    }
    return result;
}

/* A vertex in the air is where an outermost cell would take it, which may be flat or inside out: on the edge, it keeps
   its place beside the nearest vertex before it that is in material, or the first one, or the one nearest to it. seen:
   the vertices with their places on the edge of the last move */
static void gxp_place_air(gxp_front_vertex *v, const gxp_front_vertex *seen, uint32_t count, double end) {
    uint32_t i, base = 0;
    for (i = 1; i < count; i++)
        if (v[i].distance < v[base].distance) base = i;
    for (i = 0; i < count; i++)
        if (v[i].distance > 0)
            v[i].along = fmin(fmax(v[base].along + (seen[i].along - seen[base].along), 0), end);
        else
            base = i;
}

/* How much a vertex's place on the edge counts */
static double gxp_place_weight(const gxp_front_vertex *v) { return v->distance > 0 ? 0.001 : 1; }

/* Makes the places on the edge ascend, with the least change in squares: pools of neighbours get their mean. */
static void gxp_sort_places(gxp_front_vertex *v, uint32_t count) {
    uint32_t i, j, first;
    for (i = 1; i < count; i++) {
        double along = v[i].along, weight = gxp_place_weight(&v[i]);
        for (first = i; first > 0 && v[first - 1].along > along; first = j) {
            const double pool = v[first - 1].along;
            double sum = 0;
            for (j = first; j > 0 && !(v[j - 1].along < pool); j--) sum += gxp_place_weight(&v[j - 1]);
            along = (weight * along + sum * pool) / (weight + sum);
            weight += sum;
        }
        for (j = first; j <= i && first < i; j++) v[j].along = along;
    }
}

/* Appends a front to blade.owned, with the places on the edge that it is at now, ascending. */
static gx_result gxp_list_owned(gx_blade *blade, uint32_t layer, int old, const gxp_front_vertex *vertices,
                                uint32_t vertex_count, const double *edge, uint32_t count) {
    const uint32_t first = blade->owned.count;
    uint32_t i;
    gx_result result = gxp_push(blade->body, &blade->owned_starts, blade->owned.count);
    for (i = 0; i < vertex_count && result == GX_OK; i++) {
        gxp_front_vertex v = vertices[i];
        double x[3];
        result = gxp_front_position(blade, layer, old, &v, x);
        gxp_onto_edge(edge, count, x, &v.along);
        if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->owned, &v);
    }
    if (result != GX_OK) return result;
    gxp_place_air(blade->owned.data + first, vertices, vertex_count, count - 1);
    gxp_sort_places(blade->owned.data + first, vertex_count);
    return result;
}

/* How far a place between two is from the layer, HUGE_VAL where that is not known: all cells are inverted. */
static double gxp_distance_between(const gxp_front_vertex *a, const gxp_front_vertex *b, double share) {
    return a->distance < HUGE_VAL && b->distance < HUGE_VAL ? a->distance + share * (b->distance - a->distance)
                                                            : HUGE_VAL;
}

/* Between two places on the edge: how far an owned front is from its layer, HUGE_VAL if it is not there */
static double gxp_owned_distance(const gx_blade *blade, uint32_t owner, double from, double to) {
    const gxp_front_vertex *v = blade->owned.data;
    const uint32_t first = blade->owned_starts.data[owner], end = blade->owned_starts.data[owner + 1];
    double share;
    uint32_t i;
    for (i = first; i + 1 < end; i++)
        if (!v[i].gap && v[i].along <= from && v[i + 1].along >= to && v[i + 1].along > v[i].along) break;
    if (i + 1 >= end) return HUGE_VAL;
    if (!(v[i].distance > 0) || !(v[i + 1].distance > 0)) return 0;
    share = (0.5 * (from + to) - v[i].along) / (v[i + 1].along - v[i].along);
    return gxp_distance_between(&v[i], &v[i + 1], share);
}

/* An owned front begins to be the layer's, or ends to be it, at a place on the edge: its vertices there, or a point of
   it. */
static gx_result gxp_push_owned_place(gx_blade *blade, uint32_t owner, double along) {
    const gxp_front_vertex *v = blade->owned.data;
    const uint32_t first = blade->owned_starts.data[owner], end = blade->owned_starts.data[owner + 1],
                   before = blade->front.count;
    gxp_front_vertex at;
    double share;
    uint32_t i;
    int k;
    gx_result result = GX_OK;
    for (i = first; i < end && result == GX_OK; i++) {
        if (v[i].along < along || v[i].along > along) continue;
        at = v[i];
        at.soft = at.gap = 0;
        result = gxp_push_vertex(blade->body, &blade->front, &at);
    }
    if (blade->front.count > before || result != GX_OK) return result;
    for (i = first; i + 1 < end && v[i + 1].along <= along;) i++;
    at = v[i];
    share = (along - at.along) / (v[i + 1].along - at.along);
    for (k = 0; k < 3; k++) {
        at.rest[k] += share * (v[i + 1].rest[k] - at.rest[k]);
        at.extended[k] += share * (v[i + 1].extended[k] - at.extended[k]);
        at.position[k] += share * (v[i + 1].position[k] - at.position[k]);
    }
    at.distance = gxp_distance_between(&v[i], &v[i + 1], share);
    at.along = along;
    at.soft = at.gap = 0;
    return gxp_push_vertex(blade->body, &blade->front, &at);
}

/* The owned front that is the layer's from one place on the edge to the next: that before, or the one nearest to its
   own layer. The last one, if it is not an owner's, only where there is no other. */
static uint32_t gxp_leading_owner(const gx_blade *blade, double from, double to, uint32_t before) {
    uint32_t best = GXP_NONE, k;
    double least = HUGE_VAL;
    if (before < blade->owners.count) least = gxp_owned_distance(blade, before, from, to);
    if (least < HUGE_VAL) best = before;
    for (k = 0; k + 1 < blade->owned_starts.count; k++) {
        const double distance = gxp_owned_distance(blade, k, from, to);
        if (distance >= least || (k >= blade->owners.count && best != GXP_NONE)) continue;
        least = distance;
        best = k;
    }
    return best;
}

/* The next place on the edge at which one of the owned fronts has a vertex, HUGE_VAL if there is none */
static double gxp_next_place(const gx_blade *blade, double after) {
    double next = HUGE_VAL;
    uint32_t i;
    for (i = 0; i < blade->owned.count; i++) {
        const double along = blade->owned.data[i].along;
        if (along > after && along < next) next = along;
    }
    return next;
}

/* An owned front goes on from one place on the edge, exclusive, to another one. */
static gx_result gxp_push_owned(gx_blade *blade, uint32_t owner, double from, double to) {
    uint32_t i;
    gx_result result = GX_OK;
    for (i = blade->owned_starts.data[owner]; i < blade->owned_starts.data[owner + 1] && result == GX_OK; i++) {
        gxp_front_vertex v = blade->owned.data[i];
        v.gap = 0;
        if (v.along > from && v.along <= to) result = gxp_push_vertex(blade->body, &blade->front, &v);
    }
    return result;
}

/* The last vertex of the layer's front: the front ends there (gap 1), or another owner's begins. */
static void gxp_end_lead(gxp_front_list *front, int gap) {
    if (front->count == 0) return;
    front->data[front->count - 1].soft = 0;
    front->data[front->count - 1].gap = gap != 0;
}

/* Lists in blade.front, at each place on the edge, the owned front that is nearest to its layer there. */
static gx_result gxp_join_owned(gx_blade *blade) {
    double from, to;
    uint32_t leader = GXP_NONE;
    gx_result result = GX_OK;
    blade->front.count = 0;
    for (from = gxp_next_place(blade, -1); result == GX_OK && (to = gxp_next_place(blade, from)) < HUGE_VAL;
         from = to) {
        const uint32_t next = gxp_leading_owner(blade, from, to, leader);
        if (next != leader) {
            if (leader != GXP_NONE && blade->front.data[blade->front.count - 1].along < from)
                result = gxp_push_owned_place(blade, leader, from);
            gxp_end_lead(&blade->front, next == GXP_NONE);
            if (next != GXP_NONE && result == GX_OK) result = gxp_push_owned_place(blade, next, from);
            leader = next;
        }
        if (next != GXP_NONE && result == GX_OK) result = gxp_push_owned(blade, next, from, to);
    }
    gxp_end_lead(&blade->front, 1);
    return result;
}

/* The part of the layer's front that is beside an owner's, between places on the edge: from a corner to a corner, since
   strips go from corner to corner, and soft places are off the line between these by rounding. */
static void gxp_find_beside(const gxp_front_list *front, double from, double to, uint32_t *first, uint32_t *last) {
    const gxp_front_vertex *v = front->data;
    uint32_t i = 0, j = front->count;
    while (i < front->count && v[i].along < from) i++;
    while (j > 0 && v[j - 1].along > to) j--;
    while (i > 0 && !v[i - 1].gap && (i == front->count || v[i].soft || v[i].along > from)) i--;
    while (j < front->count && (j == 0 || (!v[j - 1].gap && (v[j - 1].soft || v[j - 1].along < to)))) j++;
    *first = i;
    *last = j;
}

/* Lists in blade.strip what closes the gap between an owner's front and that of the layer it has flowed into. */
static gx_result gxp_close_owner(gx_blade *blade, uint32_t owner) {
    const gxp_front_vertex *v = blade->owned.data;
    const uint32_t first = blade->owned_starts.data[owner], end = blade->owned_starts.data[owner + 1];
    uint32_t i, from, to;
    gx_result result;
    blade->advanced.count = blade->latest.count = 0;
    result = gxp_append_front(blade->body, &blade->latest, v + first, end - first);
    gxp_find_beside(&blade->front, v[first].along, v[end - 1].along, &from, &to);
    for (i = from; i < to && result == GX_OK; i++)
        result = gxp_push_vertex(blade->body, &blade->advanced, &blade->front.data[i]);
    if (result == GX_OK) result = gxp_zip(blade, &blade->latest, &blade->advanced);
    blade->latest.count = 0;
    return result;
}

/* Is there a place of the edge in the layer, or next to it, at which no owned front is? */
static int gxp_is_uncovered(const gx_blade *blade) {
    uint32_t i, k;
    for (i = 0; i < blade->samples.count; i++) {
        const gxp_front_vertex *v = &blade->samples.data[i];
        if (v->distance > 0.5 * v->size) continue;
        for (k = 0; k < blade->owners.count; k++)
            if (gxp_owned_distance(blade, k, v->along, v->along) < HUGE_VAL) break;
        if (k == blade->owners.count) return 1;
    }
    return 0;
}

/* An owner's front, path and sheet become those of the layer at work. */
static gx_result gxp_resume_owner(gx_blade *blade, uint32_t owner) {
    const gxp_blade_state *now = &blade->now;
    const gxp_layer *l = &now->layers.data[blade->owners.data[owner]];
    uint32_t i;
    gx_result result;
    blade->front.count = blade->latest.count = blade->path.count = 0;
    result = gxp_append_front(blade->body, &blade->front, now->vertices.data + l->front, l->front_count);
    if (result == GX_OK)
        result = gxp_append_front(blade->body, &blade->latest, now->vertices.data + l->latest, l->latest_count);
    for (i = 0; i < l->path_count && result == GX_OK; i++)
        result = gxp_push_point(blade->body, &blade->path, now->points.data + 3 * (size_t)(l->path + i));
    for (i = 0; i < l->sheet_count && result == GX_OK; i++)
        result = gxp_push_point(blade->body, &blade->sheet, now->points.data + 3 * (size_t)(l->sheet + i));
    return result;
}

/* Lists the owners' fronts in blade.owned. finish: what waits in them is cut before. */
static gx_result gxp_list_owners(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count, int finish,
                                 gx_blade_report *report) {
    uint32_t k;
    gx_result result = GX_OK;
    blade->owned.count = blade->owned_starts.count = blade->sheet.count = 0;
    for (k = 0; k < blade->owners.count && result == GX_OK; k++) {
        const uint32_t old = blade->owners.data[k];
        result = gxp_resume_owner(blade, k);
        if (finish && blade->latest.count > 0) {
            if (result == GX_OK) result = gxp_copy_front(blade->body, &blade->advanced, &blade->latest);
            if (result == GX_OK) result = gxp_zip(blade, &blade->front, &blade->advanced);
            if (result == GX_OK) result = gxp_cut_strip(blade, &blade->advanced, report);
            if (result == GX_OK) result = gxp_add_surface(blade, layer, old);
        }
        if (result == GX_OK) result = gxp_list_owned(blade, old, 1, blade->front.data, blade->front.count, edge, count);
    }
    return result == GX_OK ? gxp_push(blade->body, &blade->owned_starts, blade->owned.count) : result;
}

/* The edge of the last move was not in this layer then. If a place of it is in its material now, the layer has moved
   over it: that part of the front begins at the present places of the edge where those are in the air. */
static gx_result gxp_begin_in_air(gx_blade *blade, uint32_t layer, const double *edge, uint32_t count) {
    gxp_front_list *before = &blade->samples;
    uint32_t i, first, end;
    gx_result result = GX_OK;
    for (first = 0; first < before->count && blade->now.edge.count > 0 && result == GX_OK; first = end) {
        int inside = 0;
        for (end = first; end < before->count && (end == first || !before->data[end - 1].gap); end++)
            inside |= !(before->data[end].distance > 0);
        for (i = first; i < end && inside && result == GX_OK; i++) {
            gxp_front_vertex at;
            result = gxp_see(blade, layer, edge, count, before->data[i].along, NULL, &at);
            at.gap = before->data[i].gap;
            if (at.distance > 0) before->data[i] = at;
        }
    }
    return result;
}

/* Where no owner's front is, the edge of the last move is the layer's. */
static gx_result gxp_list_before(gx_blade *blade, uint32_t layer, const double *before, const double *edge,
                                 uint32_t count) {
    gx_result result = gxp_copy_front(blade->body, &blade->advanced, &blade->samples);
    if (result == GX_OK) result = gxp_see_edge(blade, layer, before, count);
    if (result == GX_OK) result = gxp_begin_in_air(blade, layer, edge, count);
    blade->owned_starts.count--;
    if (result == GX_OK)
        result = gxp_list_owned(blade, layer, 0, blade->samples.data, blade->samples.count, edge, count);
    if (result == GX_OK) result = gxp_push(blade->body, &blade->owned_starts, blade->owned.count);
    return result == GX_OK ? gxp_copy_front(blade->body, &blade->samples, &blade->advanced) : result;
}

/* The layer's front is made of several. Where it is not that of one of its owners, the gap between them is cut. */
static gx_result gxp_unite_owners(gx_blade *blade, uint32_t layer) {
    uint32_t k;
    gx_result result = gxp_join_owned(blade);
    for (k = 0; k < blade->owners.count && result == GX_OK; k++) {
        result = gxp_close_owner(blade, k);
        if (result == GX_OK) result = gxp_append_front(blade->body, &blade->cut, blade->strip.data, blade->strip.count);
        if (result == GX_OK) result = gxp_add_surface(blade, layer, blade->owners.data[k]);
    }
    return result;
}

/* Counts the layers into which each old one has fallen. */
static gx_result gxp_count_heirs(gx_blade *blade) {
    const uint32_t count = blade->now.layers.count;
    uint32_t layer, k;
    gx_result result = gxp_start_words(blade->body, &blade->heirs, count);
    if (result != GX_OK) return result;
    blade->heirs.count = count;
    for (k = 0; k < count; k++) blade->heirs.data[k] = 0;
    for (layer = 0; layer < blade->near.layer_count && result == GX_OK; layer++) {
        result = gxp_find_owners(blade, layer);
        for (k = 0; k < blade->owners.count; k++) blade->heirs.data[blade->owners.data[k]]++;
    }
    return result;
}

/* Keeps of a front what is near to the layer, up to the next corners. */
static gx_result gxp_trim_front(gx_blade *blade, uint32_t layer, gxp_front_list *front) {
    uint32_t first = GXP_NONE, last = 0, i;
    gx_result result = GX_OK;
    for (i = 0; i < front->count && result == GX_OK; i++) {
        gxp_front_vertex *v = &front->data[i];
        gxp_sight sight;
        double x[3];
        result = gxp_front_position(blade, layer, 0, v, x);
        if (result == GX_OK) result = gxp_seek(blade, layer, x, &sight);
        if (result != GX_OK || sight.index == GXP_NONE) continue;
        if (sight.square > 0.25 * v->size * v->size) v->distance = sqrt(sight.square);
        if (sight.square > 2.25 * v->size * v->size) continue;
        if (first == GXP_NONE) first = i;
        last = i;
    }
    if (first == GXP_NONE || result != GX_OK) return result;
    while (first > 0 && front->data[first].soft) first--;
    while (last + 1 < front->count && (front->data[last].soft || first == last)) last++;
    if (first == last) first--;
    front->count = last - first + 1;
    memmove(front->data, front->data + first, front->count * sizeof *front->data);
    front->data[front->count - 1].gap = 1;
    return GX_OK;
}

/* Keeps of the path what is in the layer. */
static gx_result gxp_trim_path(gx_blade *blade, uint32_t layer) {
    uint32_t i, n = 0;
    int inside;
    gx_result result = GX_OK;
    for (i = 0; i < blade->path.count && result == GX_OK; i++) {
        const double *x = blade->path.data + 3 * (size_t)i;
        result = gxp_is_in_layer(blade, layer, x, &inside);
        if (inside) memmove(blade->path.data + 3 * (size_t)n++, x, 3 * sizeof *x);
    }
    blade->path.count = n;
    return result;
}

/* One of several heirs of a front keeps its own part of it. */
static gx_result gxp_take_part(gx_blade *blade, uint32_t layer) {
    uint32_t k, shared = 0;
    gx_result result;
    for (k = 0; k < blade->owners.count; k++) shared |= blade->heirs.data[blade->owners.data[k]] > 1;
    if (!shared) return GX_OK;
    result = gxp_trim_front(blade, layer, &blade->front);
    if (result == GX_OK) result = gxp_trim_front(blade, layer, &blade->latest);
    return result == GX_OK ? gxp_trim_path(blade, layer) : result;
}

/* Makes a new layer's front ready for a step: that of the layers that flow into it, and where none is, the edge of the
   last move. blade.samples: how the layer sees the edge of the step. *begun: there is no such layer. */
static gx_result gxp_begin_layer(gx_blade *blade, uint32_t layer, const double *before, const double *edge,
                                 uint32_t count, gx_blade_report *report, int *begun) {
    gx_result result = gxp_find_owners(blade, layer);
    int uncovered = 0, many = blade->owners.count > 1;
    blade->cut.count = blade->front.count = blade->latest.count = blade->path.count = 0;
    *begun = result == GX_OK && blade->owners.count == 0;
    if (result == GX_OK) result = gxp_see_edge(blade, layer, edge, count);
    if (result == GX_OK) result = gxp_list_beads(blade, layer);
    if (result == GX_OK) result = gxp_list_owners(blade, layer, edge, count, 0, report);
    if (result == GX_OK && !*begun) uncovered = gxp_is_uncovered(blade);
    if (result == GX_OK && !(*begun || uncovered || many)) return gxp_take_part(blade, layer);
    if (result == GX_OK && !*begun) result = gxp_list_owners(blade, layer, edge, count, 1, report);
    if (result == GX_OK && (*begun || gxp_is_uncovered(blade)))
        result = gxp_list_before(blade, layer, before, edge, count);
    if (result == GX_OK) result = gxp_unite_owners(blade, layer);
    if (result == GX_OK && blade->front.count < 2)
        result = gxp_append_front(blade->body, &blade->front, blade->owned.data, blade->owned_starts.data[1]);
    return result == GX_OK ? gxp_take_part(blade, layer) : result;
}

/* How far the edge can go before it is farther than an element from the layer at work */
static double gxp_way_out(const gx_blade *blade) {
    double most = 0;
    uint32_t i;
    for (i = 0; i < blade->samples.count; i++)
        most = fmax(most, blade->samples.data[i].size - blade->samples.data[i].distance);
    return most;
}

/* Writes the layer at work to the state that the move makes. */
static gx_result gxp_keep_layer(gx_blade *blade) {
    gxp_blade_state *then = &blade->then;
    gxp_layer layer;
    uint32_t i;
    gx_result result = gxp_reserve(&blade->body->config.allocator, &then->layers.data, sizeof *then->layers.data,
                                   then->layers.count, &then->layers.capacity, 1);
    layer.front = then->vertices.count;
    layer.front_count = blade->front.count;
    if (result == GX_OK) result = gxp_append_front(blade->body, &then->vertices, blade->front.data, blade->front.count);
    layer.latest = then->vertices.count;
    layer.latest_count = blade->latest.count;
    if (blade->latest.count > 0) blade->room = fmin(blade->room, gxp_way_out(blade));
    if (result == GX_OK)
        result = gxp_append_front(blade->body, &then->vertices, blade->latest.data, blade->latest.count);
    layer.seen = then->vertices.count;
    layer.seen_count = blade->samples.count;
    if (result == GX_OK)
        result = gxp_append_front(blade->body, &then->vertices, blade->samples.data, blade->samples.count);
    layer.path = then->points.count;
    layer.path_count = blade->path.count;
    for (i = 0; i < blade->path.count && result == GX_OK; i++)
        result = gxp_push_point(blade->body, &then->points, blade->path.data + 3 * (size_t)i);
    layer.sheet = then->points.count;
    layer.sheet_count = blade->sheet.count;
    for (i = 0; i < blade->sheet.count && result == GX_OK; i++)
        result = gxp_push_point(blade->body, &then->points, blade->sheet.data + 3 * (size_t)i);
    if (result == GX_OK) then->layers.data[then->layers.count++] = layer;
    return result;
}

/* The box of the body's copies, in space. Those of removed material count too. */
static void gxp_find_box(const gx_body *body, gxp_bounds *box) {
    uint32_t i;
    int k;
    for (k = 0; k < 3; k++) box->low[k] = HUGE_VAL, box->high[k] = -HUGE_VAL;
    for (i = 0; i < body->copies.count; i++)
        for (k = 0; k < 3; k++) {
            const double x = body->mesh.positions[3 * (size_t)body->copies.node[i] + (size_t)k] +
                             body->copies.displacement[3 * (size_t)i + (size_t)k];
            box->low[k] = x < box->low[k] ? x : box->low[k];
            box->high[k] = x > box->high[k] ? x : box->high[k];
        }
}

static void gxp_find_middle(const gx_body *body, double middle[3]) {
    gxp_bounds box;
    int k;
    gxp_find_box(body, &box);
    for (k = 0; k < 3; k++) middle[k] = box.low[k] > box.high[k] ? 0 : 0.5 * box.low[k] + 0.5 * box.high[k];
}

/* No layer is near: keeps the place on the edge that is nearest to the body's box, and the material next to it. */
static gx_result gxp_keep_far_place(gx_blade *blade, const double *edge, uint32_t count) {
    static const double origin[3] = {0, 0, 0};
    gx_body *body = blade->body;
    gxp_bounds box;
    const uint32_t parts = count < 32 ? 32 / (count - 1) : 1;
    double least = HUGE_VAL, corners[4][3];
    gxp_front_vertex v;
    gxp_near near;
    uint32_t i;
    gx_result result;
    memset(&v, 0, sizeof v);
    gxp_find_box(body, &box);
    for (i = 0; i <= parts * (count - 1); i++) {
        double x[3], square;
        gxp_edge_position(edge, count, (double)i / parts, x);
        square = gxp_square_to_box(x, box.low, box.high);
        if (square >= least) continue;
        least = square;
        v.along = (double)i / parts;
        memcpy(v.position, x, sizeof x);
    }
    if (!(least < 64 * blade->largest * blade->largest)) return GX_OK;
    result = gxp_refit_tree(body);
    if (result == GX_OK) result = gxp_find_nearest(body, v.position, NULL, NULL, &near);
    if (result != GX_OK || near.cell == GXP_NONE) return result;
    v.element = body->cells.data[near.cell].element;
    v.size = blade->largest;
    v.distance = sqrt(near.square);
    gxp_image_by(body, &body->cells.data[near.cell], near.weights, v.foot_at);
    gxp_cell_corners(body, &body->cells.data[near.cell], 0, origin, corners);
    gxp_weigh(corners, near.weights, v.foot);
    memcpy(v.rest, v.foot, sizeof v.rest);
    memcpy(v.extended, v.foot, sizeof v.extended);
    blade->front.count = blade->latest.count = blade->path.count = blade->sheet.count = blade->samples.count = 0;
    result = gxp_push_vertex(body, &blade->samples, &v);
    return result == GX_OK ? gxp_keep_layer(blade) : result;
}

/* Notes which cells belong to which layer, and where the edge is. */
static gx_result gxp_keep_members(gx_blade *blade, const double *edge, uint32_t count) {
    gxp_blade_state *then = &blade->then;
    uint32_t i;
    gx_result result = GX_OK;
    then->members.count = then->edge.count = 0;
    then->slot_count = blade->body->slots.count;
    if (blade->near.layer_count == 0) result = gxp_keep_far_place(blade, edge, count);
    if (blade->near.layer_count == 0)
        gxp_find_middle(blade->body, then->middle);
    else
        memset(then->middle, 0, sizeof then->middle);
    for (i = 0; i < blade->near.count && result == GX_OK; i++)
        result = gxp_push_key(blade->body, &then->members, blade->body->cells.slot[blade->near.cells[i].cell],
                              blade->near.cells[i].layer);
    if (result == GX_OK) result = gxp_sort_keys(blade->body, &then->members, 0, then->members.count);
    for (i = 0; i < count && result == GX_OK; i++)
        result = gxp_push_point(blade->body, &then->edge, edge + 3 * (size_t)i);
    return result;
}

/* >>ways: where the edge goes between two moves -------------------------------------------------------------------- */
/* In: the edge of the last move, and the new one. Out: the way between them, from where the material has carried the
   old edge to, and in how many steps the edge goes it. Touches the blade's working memory. */

static int gxp_compare_places(const void *a, const void *b) {
    const gxp_front_vertex *v = (const gxp_front_vertex *)a, *w = (const gxp_front_vertex *)b;
    const double by[2][2] = {{v->along, w->along}, {v->distance, w->distance}};
    int i;
    for (i = 0; i < 2; i++)
        if (by[i][0] < by[i][1] || by[i][0] > by[i][1]) return by[i][0] < by[i][1] ? -1 : 1;
    return (v->element > w->element) - (v->element < w->element);
}

/* How near to a layer the edge was at the last move, m */
static double gxp_least_distance(const gxp_blade_state *now) {
    double least = HUGE_VAL;
    uint32_t j, i;
    for (j = 0; j < now->layers.count; j++)
        for (i = 0; i < now->layers.data[j].seen_count; i++)
            least = fmin(least, now->vertices.data[now->layers.data[j].seen + i].distance);
    return least;
}

/* Drops places that have moved as others next to them, but for points of the edge. */
static void gxp_thin_places(gx_blade *blade) {
    gxp_front_list *places = &blade->places;
    uint32_t i, n = 0;
    for (i = 0; i < places->count; i++) {
        const gxp_front_vertex *v = &places->data[i];
        if (n > 0 && i + 1 < places->count && floor(v->along) < v->along &&
            gxp_square_distance(v->rest, places->data[n - 1].rest) <= blade->tolerance * blade->tolerance)
            continue;
        places->data[n++] = *v;
    }
    places->count = n;
}

/* Lists the places of the edge of the last move at which layers saw it, and its points. A place has moved with the
   material since: rest is by how much, distance from how far away that is known. */
static gx_result gxp_list_places(gx_blade *blade) {
    const gxp_blade_state *now = &blade->now;
    const double least = gxp_least_distance(now);
    uint32_t j, i, n = 0;
    int k;
    gx_result result = GX_OK;
    gxp_front_vertex v;
    blade->places.count = 0;
    memset(&v, 0, sizeof v);
    for (i = 0; i < now->edge.count && result == GX_OK; i++) {
        v.along = i;
        v.distance = HUGE_VAL;
        result = gxp_push_vertex(blade->body, &blade->places, &v);
    }
    for (j = 0; j < now->layers.count && result == GX_OK; j++)
        for (i = 0; i < now->layers.data[j].seen_count && result == GX_OK; i++) {
            double x[3];
            v = now->vertices.data[now->layers.data[j].seen + i];
            if (v.distance > fmax(least, 0.25 * v.size)) continue;
            memcpy(x, v.foot_at, sizeof x);
            result = gxp_place_by(blade, j, 1, &v, v.foot, x);
            for (k = 0; k < 3; k++) v.rest[k] = x[k] - v.foot_at[k];
            if (gxp_dot(v.rest, v.rest) <= 1e-24 * v.size * v.size) v.rest[0] = v.rest[1] = v.rest[2] = 0;
            if (result == GX_OK) result = gxp_push_vertex(blade->body, &blade->places, &v);
        }
    if (result != GX_OK) return result;
    qsort(blade->places.data, blade->places.count, sizeof *blade->places.data, gxp_compare_places);
    for (i = 1; i < blade->places.count; i++) { /* of several at one place, that of the nearest layer */
        const gxp_front_vertex *last = &blade->places.data[n];
        if (blade->places.data[i].along > last->along) blade->places.data[++n] = blade->places.data[i];
    }
    blade->places.count = n + 1;
    return GX_OK;
}

/* Points of the edge at which no layer saw it have moved as the places next to them; if no layer did, as the body's
   box. */
static void gxp_carry_far_points(gx_blade *blade) {
    gxp_front_list *places = &blade->places;
    uint32_t i, near = GXP_NONE;
    double way[3];
    int k;
    for (i = 0; i < places->count && near == GXP_NONE; i++)
        if (places->data[i].distance < HUGE_VAL) near = i;
    if (near == GXP_NONE) gxp_find_middle(blade->body, way);
    for (k = 0; k < 3; k++) way[k] = near == GXP_NONE ? way[k] - blade->now.middle[k] : places->data[near].rest[k];
    for (i = 0; i < places->count; i++)
        if (places->data[i].distance < HUGE_VAL)
            memcpy(way, places->data[i].rest, sizeof way);
        else
            memcpy(places->data[i].rest, way, sizeof way);
}

/* Lists the way of the edge: where the material has carried it to, and where it goes. */
static gx_result gxp_carry_edge(gx_blade *blade, const double *edge, uint32_t count) {
    const double *old = blade->now.edge.data;
    uint32_t i;
    int k;
    gx_result result = gxp_list_places(blade);
    blade->carried.count = blade->goal.count = 0;
    if (result == GX_OK) gxp_carry_far_points(blade);
    if (result == GX_OK) gxp_thin_places(blade);
    for (i = 0; i < blade->places.count && result == GX_OK; i++) {
        const gxp_front_vertex *v = &blade->places.data[i];
        double x[3];
        gxp_edge_position(old, count, v->along, x);
        for (k = 0; k < 3; k++) x[k] += v->rest[k];
        result = gxp_push_point(blade->body, &blade->carried, x);
        gxp_edge_position(edge, count, v->along, x);
        if (result == GX_OK) result = gxp_push_point(blade->body, &blade->goal, x);
    }
    return result;
}

/* How far the edge goes in space, squared; in a box, or NULL: anywhere */
static gx_result gxp_measure_way(gx_blade *blade, const double *before, const double *edge, uint32_t count,
                                 const gxp_bounds *box, double *most) {
    double along;
    uint32_t i, q;
    int n, k;
    gx_result result = GX_OK;
    *most = 0;
    blade->quads.count = 0;
    for (i = 0; i + 1 < count && result == GX_OK; i++)
        result = gxp_sweep_segment(blade, before + 3 * (size_t)i, edge + 3 * (size_t)i);
    for (q = 0; q < blade->quads.count && result == GX_OK; q += 4) {
        const double *x = blade->quads.data + 3 * (size_t)q;
        int beyond = 0;
        for (k = 0; k < 3 && box != NULL; k++) {
            beyond |= fmin(fmin(x[k], x[3 + k]), fmin(x[6 + k], x[9 + k])) > box->high[k] + blade->largest;
            beyond |= fmax(fmax(x[k], x[3 + k]), fmax(x[6 + k], x[9 + k])) < box->low[k] - blade->largest;
        }
        for (n = 0; n < 4 && !beyond; n++)
            *most = fmax(*most, gxp_onto_edge(n < 2 ? edge : before, count, x + 3 * n, &along));
    }
    return result;
}

/* How far the edge goes relative to the material, squared: where a layer has seen it, or else anywhere */
static double gxp_measure_relative(const gx_blade *blade) {
    const uint32_t count = blade->goal.count;
    double most = 0, along;
    uint32_t i, known = 0;
    for (i = 0; i < count; i++) known += blade->places.data[i].distance < HUGE_VAL;
    for (i = 0; i < count; i++)
        if (known == 0 || blade->places.data[i].distance < HUGE_VAL)
            most = fmax(most, gxp_onto_edge(blade->goal.data, count, blade->carried.data + 3 * (size_t)i, &along));
    return most;
}

/* The way of the edge is straight in space. */
static gx_result gxp_go_straight(gx_blade *blade, const double *before, const double *edge, uint32_t count) {
    uint32_t i;
    gx_result result = GX_OK;
    blade->carried.count = blade->goal.count = 0;
    for (i = 0; i < count && result == GX_OK; i++) {
        result = gxp_push_point(blade->body, &blade->carried, before + 3 * (size_t)i);
        if (result == GX_OK) result = gxp_push_point(blade->body, &blade->goal, edge + 3 * (size_t)i);
    }
    return result;
}

/* A move has at most so many steps, by the length of the body at rest: the way to huge displacements has no end. */
static double gxp_most_steps(const gx_blade *blade) {
    const gxp_box *all = &blade->body->mesh.boxes[0];
    return fmin(1000, 16 + 8 * sqrt(gxp_square_distance(all->low, all->high)) / blade->step);
}

/* Finds the way of the edge, and in how many steps it goes: by at most an element each in space, or relative to the
   material if that is less. */
static gx_result gxp_plan_way(gx_blade *blade, const double *edge, uint32_t count, uint32_t *steps) {
    const double *before = blade->now.edge.data, square = blade->step * blade->step;
    double most = 0;
    gxp_bounds box;
    gx_result result;
    *steps = 1;
    if (blade->now.edge.count == 0) return gxp_go_straight(blade, edge, edge, count);
    if (gxp_measure_edge(blade, edge, count) <= blade->step) return gxp_go_straight(blade, before, edge, count);
    result = gxp_measure_way(blade, before, edge, count, NULL, &most);
    if (result == GX_OK && most > square) {
        gxp_find_box(blade->body, &box);
        result = gxp_measure_way(blade, before, edge, count, &box, &most);
    }
    if (result == GX_OK && most > square) {
        result = gxp_carry_edge(blade, edge, count);
        if (result == GX_OK)
            *steps = (uint32_t)fmin(gxp_most_steps(blade),
                                    1 + floor(sqrt(fmin(most, gxp_measure_relative(blade)) / square)));
    }
    return result == GX_OK && *steps == 1 ? gxp_go_straight(blade, before, edge, count) : result;
}

/* A place of the edge's way: share of it */
static gx_result gxp_go_part(gx_blade *blade, double share, gxp_points *to) {
    const double *a = blade->carried.data, *b = blade->goal.data;
    uint32_t i;
    gx_result result = GX_OK;
    to->count = 0;
    for (i = 0; i < blade->goal.count && result == GX_OK; i++, a += 3, b += 3) {
        const double x[3] = {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
        result = gxp_push_point(blade->body, to, share < 1 ? x : b);
    }
    return result;
}

/* >>blade: the blade's moves --------------------------------------------------------------------------------------- */
/* gx_blade_move: find the layers, advance their fronts, cut the strips in one transaction, keep the new state. On any
   error nothing of body or blade has changed. */

/* Coordinates of an edge are at most 2^GXP_EDGE_REACH: squares of distances are finite. */
#define GXP_EDGE_REACH 110

/* A blade leaves no pieces of less than this share of an element. */
#define GXP_BLADE_SPECK 1e-3

/* Cuts the body by the surfaces of all layers at once. */
static gx_result gxp_cut_surfaces(gx_blade *blade, uint32_t kind, gx_blade_report *report, gx_failure *failure) {
    gx_body *body = blade->body;
    const uint32_t count = blade->surface_starts.count / 2;
    uint32_t i;
    gx_cut_desc desc;
    gxp_not_meant least;
    gx_result result = gxp_start_words(body, &blade->triangles, blade->corners.count);
    if (result == GX_OK)
        result = gxp_reserve(&body->config.allocator, &blade->surfaces, sizeof *blade->surfaces, 0,
                             &blade->surface_capacity, count);
    if (result != GX_OK || count == 0) return gxp_end(failure, result);
    for (i = 0; i < blade->corners.count; i++) blade->triangles.data[i] = i;
    for (i = 0; i < count; i++) {
        gx_surface *s = &blade->surfaces[i];
        const uint32_t *start = blade->surface_starts.data + 2 * (size_t)i;
        const uint32_t slots_end = i + 1 < count ? start[2] : blade->scope.count,
                       corners_end = i + 1 < count ? start[3] : blade->corners.count;
        memset(s, 0, sizeof *s);
        s->kind = kind;
        s->scope_slots = blade->scope.data + start[0];
        s->scope_slot_count = slots_end - start[0];
        s->vertices = blade->corners.data + 3 * (size_t)start[1];
        s->vertex_count = corners_end - start[1];
        s->triangles = blade->triangles.data;
        s->triangle_count = s->vertex_count / 3;
        report->triangle_count += s->triangle_count;
    }
    memset(&desc, 0, sizeof desc);
    desc.surfaces = blade->surfaces;
    desc.surface_count = count;
    least.share = GXP_BLADE_SPECK;
    least.thickness = blade->tolerance;
    result = gxp_cut_body(body, &desc, kind == GX_SURFACE_SHEET ? &least : NULL, &report->cut, failure);
    if (result == GX_OK) return result;
    gxp_end(failure, result);
    return result == GX_ERROR_NOT_CLOSED ? gxp_fail(failure, result, "tool.triangles", SIZE_MAX) : result;
}

/* Blames a point of a blade's first edge that is in the material, unless it may be. */
static gx_result gxp_check_start(gx_blade *blade, gx_failure *failure) {
    uint32_t i;
    if (blade->starts_inside || blade->now.edge.count > 0) return GX_OK;
    for (i = 0; i < blade->front.count; i++)
        if (!(blade->front.data[i].distance > 0))
            return gxp_fail(failure, GX_ERROR_ARGUMENT, "edge", (size_t)ceil(blade->front.data[i].along));
    return GX_OK;
}

/* Advances the fronts of all layers to the edge, and lists the strips. */
static gx_result gxp_advance_layers(gx_blade *blade, const double *before, const double *edge, uint32_t count,
                                    int finish, gx_blade_report *report, gx_failure *failure) {
    uint32_t layer;
    gx_result result = GX_OK;
    blade->then.layers.count = blade->then.vertices.count = blade->then.points.count = 0;
    blade->then.glance.beads.count = 0;
    blade->advance = 0;
    blade->room = HUGE_VAL;
    result = gxp_count_heirs(blade);
    for (layer = 0; layer < blade->near.layer_count && result == GX_OK; layer++) {
        int begun;
        result = gxp_begin_layer(blade, layer, before, edge, count, report, &begun);
        if (result == GX_OK && begun && gxp_check_start(blade, failure) != GX_OK) return GX_ERROR_ARGUMENT;
        if (result == GX_OK) result = gxp_follow_edge(blade, finish, report);
        if (result == GX_OK) result = gxp_add_surface(blade, layer, GXP_NONE);
        if (result == GX_OK) result = gxp_keep_layer(blade);
    }
    if (blade->near.layer_count > report->layer_count) report->layer_count = blade->near.layer_count;
    return gxp_end(failure, result);
}

/* Flags the fragments of a scope in blade.in_scope. */
static gx_result gxp_flag_scope(gx_blade *blade, const uint32_t *fragments, size_t count, gx_failure *failure) {
    gx_body *body = blade->body;
    size_t i;
    gx_result result = gxp_update_view(body);
    if (result == GX_OK) result = gxp_start_words(body, &blade->in_scope, body->view.fragment_count);
    if (gxp_end(failure, result) != GX_OK) return result;
    blade->in_scope.count = body->view.fragment_count;
    memset(blade->in_scope.data, 0, blade->in_scope.count * sizeof *blade->in_scope.data);
    for (i = 0; i < count; i++) {
        if (fragments[i] >= body->view.fragment_count) return gxp_fail(failure, GX_ERROR_INDEX, "scope_fragments", i);
        blade->in_scope.data[fragments[i]] = 1;
    }
    return GX_OK;
}

static gx_result gxp_check_edge(const gx_blade *blade, const double *edge, size_t count, gx_failure *failure) {
    size_t i;
    if (edge == NULL) return gxp_refuse(failure, "edge");
    if (count < 2) return gxp_refuse(failure, "point_count");
    if (count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "point_count", SIZE_MAX);
    if (blade->now.edge.count > 0 && blade->now.edge.count != count) return gxp_refuse(failure, "point_count");
    for (i = 0; i < 3 * count; i++) {
        if (!gxp_is_finite(edge[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "edge", i / 3);
        if (fabs(edge[i]) > ldexp(1, GXP_EDGE_REACH)) return gxp_fail(failure, GX_ERROR_RANGE, "edge", i / 3);
    }
    return GX_OK;
}

static void gxp_clear_report(gx_blade_report *report) {
    memset(report, 0, sizeof *report);
    report->cut.min_link_ratio = 1;
}

/* A step of a move, from blade.from to blade.to: lists what is to be cut; blade.then is what comes of it. finish: all
   that waits is to be cut. */
static gx_result gxp_step_blade(gx_blade *blade, const gxp_words *scope, int finish, gx_blade_report *report,
                                gx_failure *failure) {
    const double *before = blade->from.data, *edge = blade->to.data;
    const uint32_t count = blade->to.count;
    gx_result result = gxp_find_layers(blade, before, edge, count, scope);
    if (gxp_end(failure, result) != GX_OK) return result;
    return gxp_advance_layers(blade, before, edge, count, finish, report, failure);
}

static void gxp_swap_states(gxp_blade_state *a, gxp_blade_state *b) {
    const gxp_blade_state c = *a;
    *a = *b;
    *b = c;
}

static void gxp_swap_points(gxp_points *a, gxp_points *b) {
    const gxp_points c = *a;
    *a = *b;
    *b = c;
}

/* The state that a step has made is that of now; the one before the move is blade.start. */
static void gxp_keep_step(gx_blade *blade, int *begun) {
    if (!*begun) gxp_swap_states(&blade->start, &blade->now);
    *begun = 1;
    gxp_swap_states(&blade->now, &blade->then);
}

/* After the last of several steps: what the layers saw has places on the user's edge, not on blade.goal. */
static void gxp_renumber_seen(gx_blade *blade) {
    const gxp_blade_state *then = &blade->then;
    const gxp_front_vertex *places = blade->places.data;
    const uint32_t last = blade->places.count - 1;
    uint32_t j, i;
    for (j = 0; j < then->layers.count; j++)
        for (i = 0; i < then->layers.data[j].seen_count; i++) {
            gxp_front_vertex *v = &then->vertices.data[then->layers.data[j].seen + i];
            const double floored = floor(v->along);
            const uint32_t at = floored < last ? (uint32_t)floored : last;
            v->along = at < last ? places[at].along + (v->along - floored) * (places[at + 1].along - places[at].along)
                                 : places[last].along;
        }
}

/* The steps of a move. *begun: the state before is blade.start. */
static gx_result gxp_step_along(gx_blade *blade, const double *edge, uint32_t count, const gxp_words *scope, int finish,
                                int *begun, gx_blade_report *report, gx_failure *failure) {
    uint32_t steps = 1, step;
    gx_result result = gxp_plan_way(blade, edge, count, &steps);
    if (result == GX_OK) result = gxp_go_part(blade, 0, &blade->from);
    if (gxp_end(failure, result) != GX_OK) return result;
    blade->steps = steps;
    for (step = 1;; step++) {
        result = gxp_end(failure, gxp_go_part(blade, step < steps ? (double)step / steps : 1, &blade->to));
        if (result == GX_OK) result = gxp_step_blade(blade, scope, finish && step == steps, report, failure);
        if (result == GX_OK && steps > 1 && step == steps) gxp_renumber_seen(blade);
        if (result == GX_OK) result = gxp_end(failure, gxp_keep_members(blade, edge, count));
        if (result != GX_OK || step == steps) return result;
        gxp_keep_step(blade, begun);
        gxp_swap_points(&blade->from, &blade->to);
    }
}

/* May moves be left out after one that was worked out just now? It has had one step. Where copies are affine, none are:
   copies.struck has no A. */
static int gxp_may_get_ready(const gx_blade *blade) {
    return blade->steps == 1 && blade->body->copies.bends == 0 && gxp_is_free(blade);
}

/* No A is the one that boxes of the tree were made for. */
static void gxp_forget_seen_bends(gx_body *body) {
    uint32_t i;
    for (i = 0; i < body->copies.count; i++)
        if (body->copies.affine[i]) body->copies.linear_seen[9 * (size_t)i] = HUGE_VAL;
}

/* Works out the move that was left out last, with the body as it was then: the first steps of the present move. No copy
   was affine then. */
static gx_result gxp_make_up(gx_blade *blade, int *begun, gx_blade_report *report, gx_failure *failure) {
    const gxp_points *edge = &blade->now.glance.edge;
    gxp_copies *copies = &blade->body->copies;
    const int bends = copies->bends;
    gx_result result;
    gxp_swap_struck(blade->body);
    copies->bends = 0;
    result = gxp_refit_near(blade, GXP_NEAR_SLACK, failure);
    if (result == GX_OK) result = gxp_step_along(blade, edge->data, edge->count, NULL, 0, begun, report, failure);
    gxp_swap_struck(blade->body);
    copies->bends = bends;
    if (bends) gxp_forget_seen_bends(blade->body);
    if (result != GX_OK) return result;
    if (gxp_may_get_ready(blade) && blade->surface_starts.count == 0)
        result = gxp_end(failure, gxp_get_ready(blade));
    else
        gxp_end_glances(&blade->then.glance);
    if (result == GX_OK) gxp_keep_step(blade, begun);
    return result;
}

/* Works out what blade.then has the beginning of: cuts. ready: moves may be left out after it. */
static gx_result gxp_finish_move(gx_blade *blade, int ready, gx_blade_report *report, gx_failure *failure) {
    const int cuts = blade->surface_starts.count > 0;
    gx_result result = GX_OK;
    if (ready)
        result = gxp_end(failure, gxp_get_ready(blade));
    else
        gxp_end_glances(&blade->then.glance);
    if (result == GX_OK && ready && cuts) gxp_note_bead_elements(blade);
    if (result == GX_OK) result = gxp_cut_surfaces(blade, GX_SURFACE_SHEET, report, failure);
    if (result == GX_OK && ready && cuts) gxp_place_beads(blade);
    if (result == GX_OK && ready && blade->body->copies.bends)
        gxp_end_glances(&blade->then.glance); /* the cut has made copies affine */
    else if (result == GX_OK && ready)
        gxp_be_ready(blade);
    return result;
}

/* Works out a move. make_up: also the last one, which was left out; then the present one may be left out in its turn.
 */
static gx_result gxp_work_out(gx_blade *blade, const double *edge, uint32_t count, const gxp_words *scope, int finish,
                              int make_up, gx_blade_report *report, gx_failure *failure) {
    int begun = 0, left_out = 0;
    const int usual = !finish && scope == NULL;
    gx_result result = GX_OK;
    blade->surface_starts.count = blade->corners.count = blade->scope.count = 0;
    if (make_up) result = gxp_make_up(blade, &begun, report, failure);
    if (result == GX_OK && make_up && usual)
        result = gxp_end(failure, gxp_try_leaving_out(blade, edge, count, &left_out));
    if (result == GX_OK && left_out) return GX_OK;
    if (result == GX_OK) result = gxp_refit_near(blade, GXP_NEAR_SLACK, failure);
    if (result == GX_OK) result = gxp_step_along(blade, edge, count, scope, finish, &begun, report, failure);
    if (result == GX_OK) result = gxp_finish_move(blade, usual && gxp_may_get_ready(blade), report, failure);
    if (result == GX_OK)
        gxp_swap_states(&blade->now, &blade->then);
    else if (begun)
        gxp_swap_states(&blade->now, &blade->start);
    return result;
}

/* A move to the edge; finish: cuts all that waits. */
static gx_result gxp_move_blade(gx_blade *blade, const double *edge, uint32_t count, const gxp_words *scope, int finish,
                                gx_blade_report *report, gx_failure *failure) {
    double motion = 0;
    gxp_verdict verdict;
    gx_result result = gxp_end(failure, gxp_judge_move(blade, edge, count, &motion, &verdict));
    gxp_clear_report(report);
    if (result != GX_OK) return result;
    if (verdict == GXP_GLANCE_LITTLE && !finish && scope == NULL) {
        report->layer_count = blade->now.members.count > 0 ? blade->now.layers.count : 0;
        return gxp_end(failure, gxp_leave_out(blade, edge, count, motion));
    }
    return gxp_work_out(blade, edge, count, scope, finish,
                        blade->now.glance.edge.count > 0 && (verdict <= GXP_GLANCE_BENT || scope != NULL), report,
                        failure);
}

GXFEM_API gx_result gx_blade_move(gx_blade *blade, const double *edge, size_t point_count,
                                  const uint32_t *scope_fragments, size_t scope_fragment_count, gx_blade_report *report,
                                  gx_failure *failure) {
    gx_blade_report own;
    gx_result result;
    if (blade == NULL) return gxp_refuse(failure, "blade");
    if (scope_fragment_count > 0 && scope_fragments == NULL) return gxp_refuse(failure, "scope_fragments");
    result = gxp_check_edge(blade, edge, point_count, failure);
    if (result == GX_OK && scope_fragment_count > 0)
        result = gxp_flag_scope(blade, scope_fragments, scope_fragment_count, failure);
    if (result != GX_OK) return result;
    result = gxp_move_blade(blade, edge, (uint32_t)point_count, scope_fragment_count > 0 ? &blade->in_scope : NULL, 0,
                            &own, failure);
    if (result == GX_OK && report != NULL) *report = own;
    return result;
}

static void gxp_forget(gxp_blade_state *state) {
    state->edge.count = state->layers.count = state->members.count = 0;
    state->vertices.count = state->points.count = state->slot_count = 0;
    gxp_end_glances(&state->glance);
}

GXFEM_API gx_result gx_blade_lift(gx_blade *blade, gx_blade_report *report, gx_failure *failure) {
    const gxp_points *edge;
    gx_blade_report own;
    gx_result result = GX_OK;
    if (blade == NULL) return gxp_refuse(failure, "blade");
    edge = gxp_last_edge(blade);
    gxp_clear_report(&own);
    if (edge->count > 0) result = gxp_move_blade(blade, edge->data, edge->count, NULL, 1, &own, failure);
    if (result != GX_OK) return result;
    gxp_forget(&blade->now);
    if (report != NULL) *report = own;
    return gxp_end(failure, GX_OK);
}

static gx_result gxp_check_blade(const gx_blade_desc *desc, gx_failure *failure) {
    if (!gxp_is_finite(desc->tolerance)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "tolerance", SIZE_MAX);
    if (!gxp_is_finite(desc->min_advance)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "min_advance", SIZE_MAX);
    if (desc->tolerance < 0) return gxp_refuse(failure, "tolerance");
    return desc->min_advance < 0 ? gxp_refuse(failure, "min_advance") : GX_OK;
}

/* Measures the elements, once in a body's life. Those that are removed count too. */
static gx_result gxp_measure_elements(gx_body *body) {
    gxp_mesh *mesh = &body->mesh;
    double sum = 0;
    uint32_t e;
    gx_result result;
    if (mesh->sizes != NULL) return GX_OK;
    result = gxp_make_column(body, &gxp_element_columns[GXP_SIZE_COLUMN], mesh->element_count);
    if (result != GX_OK) return result;
    mesh->largest_size = 0;
    for (e = 0; e < mesh->element_count; e++) {
        mesh->sizes[e] = cbrt(6 * gxp_element_volume(body, e));
        mesh->largest_size = fmax(mesh->largest_size, mesh->sizes[e]);
        sum += mesh->sizes[e];
    }
    mesh->mean_size = sum / mesh->element_count;
    return GX_OK;
}

GXFEM_API gx_result gx_blade_create(gx_body *body, const gx_blade_desc *desc, gx_blade **blade, gx_failure *failure) {
    gx_blade_desc zero;
    gx_blade *b, **place;
    double size;
    gx_result result;
    memset(&zero, 0, sizeof zero);
    if (desc == NULL) desc = &zero;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (blade == NULL) return gxp_refuse(failure, "blade");
    result = gxp_check_blade(desc, failure);
    if (result != GX_OK) return result;
    result = gxp_measure_elements(body);
    b = result == GX_OK ? (gx_blade *)gxp_allocate(&body->config.allocator, sizeof *b) : NULL;
    if (b == NULL) return gxp_end(failure, result != GX_OK ? result : GX_ERROR_MEMORY);
    memset(b, 0, sizeof *b);
    size = body->mesh.mean_size;
    b->largest = body->mesh.largest_size;
    b->body = body;
    b->tolerance = desc->tolerance > 0 ? desc->tolerance : 0.01 * size;
    b->min_advance = desc->min_advance > 0 ? desc->min_advance : 0.5 * size;
    b->step = size;
    b->max_samples = desc->max_samples > 0 ? desc->max_samples : 1000;
    b->starts_inside = desc->starts_inside != 0;
    for (place = &body->blades; *place != NULL;) place = &(*place)->next;
    *blade = *place = b;
    return gxp_end(failure, GX_OK);
}

static void gxp_release_state(gx_body *body, gxp_blade_state *s) {
    const gx_allocator *a = &body->config.allocator;
    gxp_release(a, s->vertices.data, s->vertices.capacity * sizeof *s->vertices.data);
    gxp_release(a, s->points.data, 3 * s->points.capacity * sizeof *s->points.data);
    gxp_release(a, s->layers.data, s->layers.capacity * sizeof *s->layers.data);
    gxp_release(a, s->members.data, s->members.capacity * sizeof *s->members.data);
    gxp_release(a, s->edge.data, 3 * s->edge.capacity * sizeof *s->edge.data);
    gxp_release(a, s->glance.beads.data, s->glance.beads.capacity * sizeof *s->glance.beads.data);
    gxp_release(a, s->glance.edge.data, 3 * s->glance.edge.capacity * sizeof *s->glance.edge.data);
}

static void gxp_release_words(gx_body *body, gxp_words *words) {
    gxp_release(&body->config.allocator, words->data, words->capacity * sizeof *words->data);
}

static void gxp_release_front(gx_body *body, gxp_front_list *list) {
    gxp_release(&body->config.allocator, list->data, list->capacity * sizeof *list->data);
}

static void gxp_release_points(gx_body *body, gxp_points *list) {
    gxp_release(&body->config.allocator, list->data, 3 * list->capacity * sizeof *list->data);
}

/* Releases a blade; the body's list of blades is the caller's. */
static void gxp_release_blade(gx_blade *b) {
    gx_body *body = b->body;
    const gx_allocator *a = &body->config.allocator;
    gxp_release_state(body, &b->now);
    gxp_release_state(body, &b->then);
    gxp_release_state(body, &b->start);
    gxp_release(a, b->followed.data, b->followed.capacity * sizeof *b->followed.data);
    gxp_release_front(body, &b->places);
    gxp_release_points(body, &b->carried);
    gxp_release_points(body, &b->goal);
    gxp_release_points(body, &b->from);
    gxp_release_points(body, &b->to);
    gxp_release(a, b->near.cells, b->near.capacity * sizeof *b->near.cells);
    gxp_release(a, b->near.facets, b->near.facet_capacity * sizeof *b->near.facets);
    gxp_release_words(body, &b->near.of_cell);
    gxp_release_words(body, &b->near.of_copy);
    gxp_release_words(body, &b->near.quad_start);
    gxp_release_words(body, &b->near.ranked);
    gxp_release_words(body, &b->near.parents);
    gxp_release(a, b->near.order.data, b->near.order.capacity * sizeof *b->near.order.data);
    gxp_release_words(body, &b->near.layer_start);
    gxp_release_front(body, &b->front);
    gxp_release_front(body, &b->latest);
    gxp_release_front(body, &b->seen);
    gxp_release_front(body, &b->samples);
    gxp_release_front(body, &b->advanced);
    gxp_release_front(body, &b->crossings);
    gxp_release_front(body, &b->strip);
    gxp_release_front(body, &b->cut);
    gxp_release_front(body, &b->owned);
    gxp_release_words(body, &b->owned_starts);
    gxp_release(a, b->relations, b->relation_capacity * sizeof *b->relations);
    gxp_release_points(body, &b->path);
    gxp_release_points(body, &b->sheet);
    gxp_release_points(body, &b->quads);
    gxp_release(a, b->plates, b->plate_capacity * sizeof *b->plates);
    gxp_release(a, b->boxes, b->box_capacity * sizeof *b->boxes);
    gxp_release_points(body, &b->corners);
    gxp_release_words(body, &b->owners);
    gxp_release_words(body, &b->heirs);
    gxp_release_words(body, &b->divided);
    gxp_release(a, b->halved.data, b->halved.capacity * sizeof *b->halved.data);
    gxp_release_words(body, &b->in_scope);
    gxp_release_words(body, &b->needed);
    gxp_release_words(body, &b->found);
    gxp_release_words(body, &b->scope);
    gxp_release_words(body, &b->surface_starts);
    gxp_release_words(body, &b->triangles);
    gxp_release(a, b->surfaces, b->surface_capacity * sizeof *b->surfaces);
    gxp_release(a, b->spans, b->span_capacity * sizeof *b->spans);
    gxp_release(a, b->span_order.data, b->span_order.capacity * sizeof *b->span_order.data);
    gxp_release(a, b, sizeof *b);
}

GXFEM_API void gx_blade_destroy(gx_blade *blade) {
    gx_blade **place;
    if (blade == NULL) return;
    for (place = &blade->body->blades; *place != blade;) place = &(*place)->next;
    *place = blade->next;
    gxp_release_blade(blade);
}

GXFEM_API gx_blade *gx_body_blade(const gx_body *body, size_t index) {
    gx_blade *blade = body != NULL ? body->blades : NULL;
    for (; blade != NULL && index > 0; index--) blade = blade->next;
    return blade;
}

/* >>contacts: what of the edge is in the material ------------------------------------------------------------------ */
/* In: the edge of a blade's last move, and the body as it is now. Out: the parts of the edge that are in cells (spans),
   those of cells that hang together along the edge joined, and places on them as hits. Nothing is decided exactly here:
   a place that is off a cell by next to nothing is in it, so that an edge in faces of elements is not lost between
   them. Touches the blade's working memory, the view's lists and the tree. */

/* Next to nothing: a share of the element's size, for what rounding makes of thin faces, and a share (2^-48) of the
   largest coordinate, for what it makes of positions */
#define GXP_TOUCH          1e-10
#define GXP_TOUCH_ROUNDING 3.552713678800501e-15
/* Sizes of deformed elements are the radii of balls around them: 0.8 to 0.9 for an edge of 1. Where the edge is in the
   material for less than the first share of it, it passes by a corner. Contacts are the second one apart. */
#define GXP_LEAST_CONTACT   1e-6
#define GXP_CONTACT_SPACING 0.6

/* A part of a segment of the edge */
typedef struct gxp_edge_part {
    gx_blade *blade;
    const double *ends; /* of the segment: 2 x 3, m */
    uint32_t segment;
    double low, high; /* shares of the segment */
    double x[2][3];   /* where these are, m */
    double rounding;  /* of positions, at rest too, m */
} gxp_edge_part;

/* Its part in the element of a cell */
typedef struct gxp_cell_part {
    const gxp_edge_part *edge;
    uint32_t cell;
    double low, high;  /* shares of the segment */
    double rest[2][3]; /* their material points */
    double touch;      /* m, at rest */
} gxp_cell_part;

static double gxp_between(double a, double b, double share) { return share < 1 ? a + share * (b - a) : b; }

/* Narrows a range to where a linear function, a at 0 and b at 1, is 0 or more. Returns 0 if nothing is left. */
static int gxp_narrow(double a, double b, double *low, double *high) {
    if (a < 0 && b < 0) return 0;
    if (a < 0) *low = fmax(*low, a / (a - b));
    if (b < 0) *high = fmin(*high, a / (a - b));
    return *low <= *high;
}

/* Adds a span, in the order of segments, places and cells. A walk finds them nearly in order. */
static gx_result gxp_push_span(const gxp_cell_part *part, double low, double high) {
    gx_blade *blade = part->edge->blade;
    uint32_t i = blade->span_count;
    gxp_span own;
    const gx_result result = gxp_reserve(&blade->body->config.allocator, &blade->spans, sizeof *blade->spans,
                                         blade->span_count, &blade->span_capacity, 1);
    if (result != GX_OK) return result;
    own.low = gxp_between(part->low, part->high, low);
    own.high = gxp_between(part->low, part->high, high);
    own.cell = part->cell;
    own.segment = part->edge->segment;
    for (; i > 0; i--) {
        const gxp_span *last = &blade->spans[i - 1];
        if (last->segment < own.segment || last->low < own.low || (!(last->low > own.low) && last->cell <= own.cell))
            break;
        blade->spans[i] = *last;
    }
    blade->spans[i] = own;
    blade->span_count++;
    return GX_OK;
}

/* The height of a material point over a plane of the complex, times the length of that plane's normal in its frame */
static double gxp_plane_height(const gx_body *body, const gxb_plane_filter *plane, const double rest[3]) {
    const double *origin = gxb_complex_origin(body->complex);
    double height = 0;
    int k;
    for (k = 0; k < 3; k++)
        height += plane->n[k] * (ldexp(rest[k] - origin[k], gxb_complex_shift(body->complex)) - plane->base[k]);
    return height;
}

/* Adds the spans that are in leaves of the cell below a reference to its element's tree. low, high: shares of the part.
 */
static gx_result gxp_add_leaf_spans(gx_body *body, const gxp_cell_part *part, uint32_t reference, double low,
                                    double high) {
    while (reference & 1) {
        const gxb_node *node = gxb_complex_tree_node(body->complex, reference >> 1);
        const gxb_plane_filter *plane = &gxb_complex_plane(body->complex, node->plane)->filter;
        const double touch = ldexp(part->touch * gxp_size(plane->n), gxb_complex_shift(body->complex)),
                     a = gxp_plane_height(body, plane, part->rest[0]), b = gxp_plane_height(body, plane, part->rest[1]);
        double front_low = low, front_high = high;
        gx_result result = GX_OK;
        if (gxp_narrow(a + touch, b + touch, &front_low, &front_high))
            result = gxp_add_leaf_spans(body, part, node->child[0], front_low, front_high);
        if (result != GX_OK || !gxp_narrow(touch - a, touch - b, &low, &high)) return result;
        reference = node->child[1];
    }
    return gxp_is_kept(body, reference >> 1) && body->leaves.data[reference >> 1].cell == part->cell
             ? gxp_push_span(part, low, high)
             : GX_OK;
}

/* Narrows a range of a part of the edge to what is in the deformed element of a cell. *touch: next to nothing, as a
   share of its thickness. Returns 0 if nothing is left, or if the element is flat. */
static int gxp_clip_to_element(const gxp_edge_part *edge, const gxp_cell *cell, double *low, double *high,
                               double *touch) {
    double corners[12], x[4][3], way[3], size = 0, off;
    int n, k;
    *touch = 0;
    gxp_moved_corners(edge->blade->body, cell, corners);
    for (k = 0; k < 3; k++) {
        way[k] = edge->x[1][k] - edge->x[0][k];
        for (n = 0; n < 4; n++) x[n][k] = corners[3 * n + k] - edge->x[0][k];
    }
    for (n = 1; n < 4; n++) size = fmax(size, sqrt(gxp_square_distance(x[n], x[0])));
    off = GXP_TOUCH * size + edge->rounding;
    for (k = 0; k < 4; k++) {
        const double *a = x[gxp_outward[k][0]], *b = x[gxp_outward[k][1]], *c = x[gxp_outward[k][2]];
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        double normal[3], height, margin, from, to;
        gxp_cross(normal, u, v);
        margin = off * gxp_size(normal);
        height = gxp_dot(normal, x[k]) - gxp_dot(normal, a);
        if (!(fabs(height) > margin)) return 0;
        from = height > 0 ? -gxp_dot(normal, a) : gxp_dot(normal, a);
        to = from + (height > 0 ? gxp_dot(normal, way) : -gxp_dot(normal, way));
        if (!gxp_narrow(from + margin, to + margin, low, high)) return 0;
        *touch = fmax(*touch, margin / fabs(height));
    }
    return 1;
}

/* Adds the spans of a cell's part of the edge, of which low, high and touch (as a share of an element) are known. */
static gx_result gxp_add_cell_part(gx_body *body, gxp_cell_part *part, double touch) {
    const uint32_t element = body->cells.data[part->cell].element;
    part->touch = touch * gxp_element_size(body, element);
    return gxp_add_leaf_spans(body, part, gxb_complex_root(body->complex, element), 0, 1);
}

/* In a bent cell a straight part of the edge is curved: it is halved until its chord is off by less than this share of
   the element, at most so often. The chord stands for it, and next to nothing is as much. */
#define GXP_CHORD_OFF    1e-3
#define GXP_CHORD_HALVES 6

/* Adds the spans of a part of the edge in a bent cell. low, high: shares of the part; w: the places of their points.
 */
static gx_result gxp_meet_bent(gx_body *body, gxp_cell_part *part, double low, double high, double w[2][4],
                               int halves) {
    const gxp_edge_part *edge = part->edge;
    const gxp_cell *c = &body->cells.data[part->cell];
    const double middle = 0.5 * low + 0.5 * high;
    double halved[3][4], x[3], rest[12], from = 0, to = 1, off = 0, weights[4];
    int n, k, beyond = 0;
    memcpy(halved[0], w[0], sizeof halved[0]);
    memcpy(halved[2], w[1], sizeof halved[2]);
    gxp_edge_position(edge->x[0], 2, middle, x);
    if (!gxp_place_in_bent(body, c, x, halved[1])) return GX_OK;
    for (k = 0; k < 4; k++) {
        off = fmax(off, fabs(halved[1][k] - 0.5 * w[0][k] - 0.5 * w[1][k]));
        beyond |= fmax(fmax(w[0][k], w[1][k]), halved[1][k]) < -GXP_CHORD_OFF;
    }
    if (beyond && halves > 1) return GX_OK;
    if (off > GXP_CHORD_OFF && halves < GXP_CHORD_HALVES) {
        const gx_result result = gxp_meet_bent(body, part, low, middle, halved, halves + 1);
        return result == GX_OK ? gxp_meet_bent(body, part, middle, high, halved + 1, halves + 1) : result;
    }
    for (k = 0; k < 4; k++)
        if (!gxp_narrow(w[0][k] + GXP_CHORD_OFF, w[1][k] + GXP_CHORD_OFF, &from, &to)) return GX_OK;
    gxp_element_positions(body, c->element, rest);
    for (n = 0; n < 2; n++) {
        const double share = n == 0 ? from : to;
        for (k = 0; k < 4; k++) weights[k] = w[0][k] + share * (w[1][k] - w[0][k]);
        gxp_weigh_material(rest, weights, part->rest[n]);
    }
    part->low = gxp_between(edge->low, edge->high, gxp_between(low, high, from));
    part->high = gxp_between(edge->low, edge->high, gxp_between(low, high, to));
    return gxp_add_cell_part(body, part, GXP_CHORD_OFF);
}

/* Adds the spans of a part of the edge in a cell. */
static gx_result gxp_meet_cell(gx_body *body, void *user, uint32_t cell) {
    const gxp_edge_part *edge = (const gxp_edge_part *)user;
    gx_blade *blade = edge->blade;
    const gxp_cell *c = &body->cells.data[cell];
    const uint32_t before = blade->span_count;
    gxp_cell_part part;
    gxp_close_cell close;
    double weights[2][4], point[3], low = 0, high = 1, touch;
    int n;
    gx_result result;
    part.edge = edge;
    part.cell = cell;
    if (gxp_is_bent(body, c)) {
        for (n = 0; n < 2; n++)
            if (!gxp_place_in_bent(body, c, edge->x[n], weights[n])) return GX_OK;
        result = gxp_meet_bent(body, &part, 0, 1, weights, 0);
    } else {
        if (!gxp_clip_to_element(edge, c, &low, &high, &touch)) return GX_OK;
        part.low = gxp_between(edge->low, edge->high, low);
        part.high = gxp_between(edge->low, edge->high, high);
        for (n = 0; n < 2; n++) {
            gxp_edge_position(edge->ends, 2, n == 0 ? part.low : part.high, point);
            (void)gxp_pull_back(body, cell, point, weights[0], part.rest[n]);
        }
        result = gxp_add_cell_part(body, &part, touch);
    }
    if (result != GX_OK || blade->span_count == before || gxp_close_index(&blade->near, cell) != GXP_NONE)
        return result;
    close.cell = cell;
    close.quad = 0; /* there are none */
    gxp_place_near(body, &close);
    return gxp_push_near(blade, &close);
}

/* Finds the spans of a segment of the edge, part by part. */
static gx_result gxp_meet_segment(gx_blade *blade, uint32_t segment) {
    const double *ends = gxp_last_edge(blade)->data + 3 * (size_t)segment;
    const uint32_t parts = gxp_part_count(blade, ends);
    gxp_edge_part edge;
    double most = 0;
    uint32_t i;
    int k;
    gx_result result = GX_OK;
    for (k = 0; k < 6; k++) most = fmax(most, fmax(fabs(ends[k]), blade->body->tree.reach[k % 3]));
    edge.blade = blade;
    edge.ends = ends;
    edge.segment = segment;
    edge.rounding = GXP_TOUCH_ROUNDING * most;
    for (i = 0; i < parts && result == GX_OK; i++) {
        gxp_bounds box;
        edge.low = (double)i / parts;
        edge.high = (double)(i + 1) / parts;
        gxp_edge_position(ends, 2, edge.low, edge.x[0]);
        gxp_edge_position(ends, 2, edge.high, edge.x[1]);
        for (k = 0; k < 3; k++) {
            box.low[k] = fmin(edge.x[0][k], edge.x[1][k]) - edge.rounding - GXP_TOUCH * blade->largest;
            box.high[k] = fmax(edge.x[0][k], edge.x[1][k]) + edge.rounding + GXP_TOUCH * blade->largest;
        }
        result = gxp_walk_box(blade->body, &box, gxp_meet_cell, &edge);
    }
    return result;
}

/* A span by its place in the order of layers */
static gxp_span *gxp_span_at(const gx_blade *blade, uint32_t index) {
    return &blade->spans[GXP_SECOND(blade->span_order.data[index])];
}

/* Does a span go on where others of its layer have come to? */
static int gxp_goes_on(const gxp_span *span, const gxp_span *reach) {
    if (span->segment == reach->segment) return span->low <= reach->high;
    return span->segment == reach->segment + 1 && reach->high >= 1; /* the point between the two is in the layer */
}

/* Sorts the spans by layer, and takes from each what is in those before it: so a layer has each place once. */
static gx_result gxp_join_spans(gx_blade *blade) {
    gxp_keys *order = &blade->span_order;
    const gxp_span *reach = NULL;
    uint32_t i;
    gx_result result = gxp_number_layers(blade);
    order->count = 0;
    if (result == GX_OK) result = gxp_keys_room(blade->body, order, 2 * (size_t)blade->span_count);
    for (i = 0; i < blade->span_count && result == GX_OK; i++)
        result = gxp_push_key(blade->body, order, gxp_layer_of(&blade->near, blade->spans[i].cell), i);
    if (result == GX_OK) result = gxp_sort_keys(blade->body, order, 0, order->count);
    for (i = 0; i < order->count; i++) {
        gxp_span *span = gxp_span_at(blade, i);
        span->begins =
            reach == NULL || GXP_FIRST(order->data[i]) != GXP_FIRST(order->data[i - 1]) || !gxp_goes_on(span, reach);
        if (!span->begins && span->segment == reach->segment) span->low = reach->high;
        if (span->high < span->low) span->high = span->low;
        reach = span;
    }
    return result;
}

/* The hit of a place on the edge in a cell, or next to nothing off it */
static void gxp_hit_on_edge(gx_body *body, uint32_t cell, const double point[3], gx_hit *hit) {
    double weights[4], material[3], sum = 0;
    int n;
    (void)gxp_pull_back(body, cell, point, weights, material);
    for (n = 0; n < 4; n++) sum += fmax(weights[n], 0);
    for (n = 0; n < 4; n++) weights[n] /= sum;
    gxp_start_hit(body, cell, weights, hit);
    memcpy(hit->material, material, sizeof hit->material);
    memcpy(hit->position, point, sizeof hit->position);
}

static double gxp_span_length(const gx_blade *blade, const gxp_span *span) {
    const double *ends = gxp_last_edge(blade)->data + 3 * (size_t)span->segment;
    return (span->high - span->low) * sqrt(gxp_square_distance(ends, ends + 3));
}

/* How long a run of joined spans is, and into how many contacts it is divided */
static double gxp_measure_run(const gx_blade *blade, uint32_t first, uint32_t end, size_t *parts) {
    double length = 0, sum = 0;
    uint32_t i;
    for (i = first; i < end; i++) {
        const gxp_span *span = gxp_span_at(blade, i);
        const double own = gxp_span_length(blade, span);
        length += own;
        sum += own * blade->near.cells[gxp_close_index(&blade->near, span->cell)].radius;
    }
    *parts = 0;
    if (!(length * length > GXP_LEAST_CONTACT * sum)) return length;
    *parts = (size_t)(length * length / (GXP_CONTACT_SPACING * sum) + 0.5);
    if (*parts == 0) *parts = 1;
    return length;
}

/* The contact at a place in a run, m from its beginning. *at, *passed: the span in which the search begins and the
   length of those before it; then those of the place */
static void gxp_place_contact(gx_blade *blade, double place, uint32_t *at, double *passed, gx_blade_contact *contact) {
    const gxp_span *span = gxp_span_at(blade, *at);
    double share, point[3];
    while (*passed + gxp_span_length(blade, span) < place) { /* the run is longer: sums are those of gxp_measure_run */
        *passed += gxp_span_length(blade, span);
        span = gxp_span_at(blade, ++*at);
    }
    share = fmin(span->low + (span->high - span->low) * ((place - *passed) / gxp_span_length(blade, span)), span->high);
    gxp_edge_position(gxp_last_edge(blade)->data + 3 * (size_t)span->segment, 2, share, point);
    gxp_hit_on_edge(blade->body, span->cell, point, &contact->hit);
    contact->along = span->segment + share;
}

/* Divides each run of joined spans into equal lengths, each with a contact in its middle. */
static void gxp_place_contacts(gx_blade *blade, gx_blade_contact *contacts, size_t capacity, size_t *count) {
    uint32_t first, end;
    *count = 0;
    for (first = 0; first < blade->span_order.count; first = end) {
        double length, passed = 0;
        size_t parts, i;
        uint32_t at = first;
        for (end = first + 1; end < blade->span_order.count && !gxp_span_at(blade, end)->begins;) end++;
        length = gxp_measure_run(blade, first, end, &parts);
        for (i = 0; i < parts && *count + i < capacity; i++) {
            gx_blade_contact *contact = &contacts[*count + i];
            contact->length = length / (double)parts;
            gxp_place_contact(blade, ((double)i + 0.5) * contact->length, &at, &passed, contact);
        }
        *count += parts;
    }
}

/* Finds all spans, joined by layer. */
static gx_result gxp_find_spans(gx_blade *blade) {
    uint32_t i;
    gx_result result = gxp_extend_words(blade->body, &blade->near.of_cell, blade->body->cells.count);
    for (i = 0; i + 1 < blade->now.edge.count && result == GX_OK; i++) result = gxp_meet_segment(blade, i);
    return result == GX_OK ? gxp_join_spans(blade) : result;
}

GXFEM_API gx_result gx_blade_contacts(gx_blade *blade, gx_blade_contact *contacts, size_t capacity, size_t *count,
                                      gx_failure *failure) {
    gx_result result;
    if (blade == NULL) return gxp_refuse(failure, "blade");
    if (contacts == NULL && capacity > 0) return gxp_refuse(failure, "contacts");
    if (count == NULL) return gxp_refuse(failure, "count");
    if (blade->now.edge.count == 0) {
        *count = 0;
        return gxp_end(failure, GX_OK);
    }
    result = gxp_prepare_locate(blade->body, failure);
    if (result != GX_OK && result != GX_ERROR_EMPTY) return result;
    blade->near.count = blade->quads.count = blade->span_count = blade->span_order.count = 0;
    if (result == GX_OK) result = gxp_find_spans(blade);
    if (gxp_end(failure, result == GX_ERROR_EMPTY ? GX_OK : result) != GX_OK) return result;
    gxp_place_contacts(blade, contacts, capacity, count);
    return *count > capacity ? gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX) : GX_OK;
}

/* >>carve: what a closed tool in space covers ---------------------------------------------------------------------- */
/* gx_body_carve: find the layers around the tool, divide its triangles as finely as the elements of each, map them
   back, and remove what they enclose there, in one cut. On any error the body is as it was. */

/* Tools are divided into at most so many triangles. */
#define GXP_TOOL_TRIANGLES 1000000u

/* Appends a place of the tool to blade.samples. Outside the layer its material point is as far away as the tool is: a
   tool that covers much of a layer must not be drawn in. */
static gx_result gxp_push_tool_place(gx_blade *blade, uint32_t layer, const double position[3]) {
    gxp_front_vertex v;
    int inside = 0;
    gx_result result;
    memset(&v, 0, sizeof v);
    memcpy(v.position, position, sizeof v.position);
    result = gxp_see_place(blade, layer, NULL, &v);
    if (result == GX_OK && v.distance > 0) result = gxp_is_in_layer(blade, layer, v.extended, &inside);
    if (!inside) memcpy(v.rest, v.extended, sizeof v.rest);
    return result == GX_OK ? gxp_push_vertex(blade->body, &blade->samples, &v) : result;
}

/* The tool as a layer sees it: its vertices are blade.samples, its triangles blade.triangles. */
static gx_result gxp_see_tool(gx_blade *blade, uint32_t layer, const gx_surface *tool) {
    size_t i;
    gx_result result = gxp_start_words(blade->body, &blade->triangles, 3 * tool->triangle_count);
    blade->last_sight = GXP_NONE;
    blade->samples.count = 0;
    for (i = 0; i < tool->vertex_count && result == GX_OK; i++)
        result = gxp_push_tool_place(blade, layer, tool->vertices + 3 * i);
    if (result != GX_OK) return result;
    memcpy(blade->triangles.data, tool->triangles, 3 * tool->triangle_count * sizeof *tool->triangles);
    blade->triangles.count = 3 * (uint32_t)tool->triangle_count;
    return GX_OK;
}

static uint64_t gxp_edge_key(uint32_t a, uint32_t b) { return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a; }

/* Lists in blade.owners the edges that are to be halved, ascending: those between places that are farther apart than
   half an element, where the layer may be. Both triangles of an edge agree. */
static gx_result gxp_list_long_edges(gx_blade *blade, gxp_keys *halved) {
    const gxp_front_vertex *v = blade->samples.data;
    uint32_t i, n = 0;
    gx_result result = gxp_keys_room(blade->body, halved, 2 * (size_t)blade->triangles.count);
    halved->count = 0;
    for (i = 0; i < blade->triangles.count && result == GX_OK; i++) {
        const uint32_t a = blade->triangles.data[i], b = blade->triangles.data[i % 3 == 2 ? i - 2 : i + 1];
        const double length = sqrt(gxp_square_distance(v[a].position, v[b].position));
        if (v[a].distance > 0 && v[b].distance > 0 && v[a].distance + v[b].distance > length) continue;
        if (length > 0.5 * (v[a].size < v[b].size ? v[a].size : v[b].size))
            halved->data[halved->count++] = gxp_edge_key(a, b);
    }
    if (result == GX_OK) result = gxp_sort_keys(blade->body, halved, 0, halved->count);
    for (i = 0; i < halved->count && result == GX_OK; i++)
        if (n == 0 || halved->data[n - 1] != halved->data[i]) halved->data[n++] = halved->data[i];
    halved->count = n;
    return result;
}

/* The vertex in the middle of an edge, if it is halved; GXP_NONE: it is not */
static uint32_t gxp_middle_vertex(const gxp_keys *halved, uint32_t first, uint32_t a, uint32_t b) {
    const uint64_t key = gxp_edge_key(a, b);
    const uint32_t i = gxp_first_key(halved, key);
    return i < halved->count && halved->data[i] == key ? first + i : GXP_NONE;
}

static gx_result gxp_push_triangle(gx_body *body, gxp_words *out, uint32_t a, uint32_t b, uint32_t c) {
    gx_result result = gxp_words_room(body, out, 3);
    if (result != GX_OK) return result;
    out->data[out->count++] = a;
    out->data[out->count++] = b;
    out->data[out->count++] = c;
    return result;
}

/* Divides a triangle by the middles of its edges, m[k] of corner k and the next. */
static gx_result gxp_divide_triangle(gx_body *body, const uint32_t t[3], const uint32_t m[3], gxp_words *out) {
    uint32_t k, halved = 0, first = 0;
    gx_result result;
    for (k = 0; k < 3; k++) halved += m[k] != GXP_NONE;
    if (halved == 0) return gxp_push_triangle(body, out, t[0], t[1], t[2]);
    if (halved == 3) {
        result = gxp_push_triangle(body, out, m[0], m[1], m[2]);
        for (k = 0; k < 3 && result == GX_OK; k++) result = gxp_push_triangle(body, out, t[k], m[k], m[(k + 2) % 3]);
        return result;
    }
    /* edge `first` is halved, and the next one too if two are */
    while (m[first] == GXP_NONE || (halved == 2 && m[(first + 1) % 3] == GXP_NONE)) first++;
    {
        const uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3], ab = m[first],
                       bc = m[(first + 1) % 3];
        result = gxp_push_triangle(body, out, a, ab, halved == 1 ? c : bc);
        if (halved == 1) return result == GX_OK ? gxp_push_triangle(body, out, ab, b, c) : result;
        if (result == GX_OK) result = gxp_push_triangle(body, out, ab, b, bc);
        return result == GX_OK ? gxp_push_triangle(body, out, a, bc, c) : result;
    }
}

/* How often the edges of the tool may be halved: twice as often as the longest one must be, and some more. Beside edges
   that stay long, as far from the layer, others may be halved for ever. */
static uint32_t gxp_tool_rounds(const gx_blade *blade) {
    const gxp_front_vertex *v = blade->samples.data;
    double most = 1;
    uint32_t i;
    for (i = 0; i < blade->triangles.count; i++) {
        const uint32_t a = blade->triangles.data[i], b = blade->triangles.data[i % 3 == 2 ? i - 2 : i + 1];
        const double size = v[a].size < v[b].size ? v[a].size : v[b].size;
        most = fmax(most, sqrt(gxp_square_distance(v[a].position, v[b].position)) / size);
    }
    return 8 + (uint32_t)(2 * log2(fmin(most, 1e100)));
}

/* Halves the edges of the tool until all that are near the layer are short. */
static gx_result gxp_refine_tool(gx_blade *blade, uint32_t layer) {
    gx_body *body = blade->body;
    gxp_keys *halved = &blade->halved;
    gxp_words *divided = &blade->divided;
    uint32_t rounds = gxp_tool_rounds(blade);
    gx_result result = gxp_list_long_edges(blade, halved);
    for (; result == GX_OK && halved->count > 0 && blade->triangles.count < 3 * GXP_TOOL_TRIANGLES && rounds > 0;
         rounds--) {
        const uint32_t first = blade->samples.count;
        gxp_words swap;
        uint32_t i, k, n;
        for (i = 0; i < halved->count && result == GX_OK; i++) {
            const gxp_front_vertex *a = &blade->samples.data[GXP_FIRST(halved->data[i])],
                                   *b = &blade->samples.data[GXP_SECOND(halved->data[i])];
            double middle[3];
            for (n = 0; n < 3; n++) middle[n] = 0.5 * a->position[n] + 0.5 * b->position[n];
            result = gxp_push_tool_place(blade, layer, middle);
        }
        divided->count = 0;
        for (i = 0; i < blade->triangles.count && result == GX_OK; i += 3) {
            const uint32_t *t = blade->triangles.data + i;
            uint32_t middle[3];
            for (k = 0; k < 3; k++) middle[k] = gxp_middle_vertex(halved, first, t[k], t[(k + 1) % 3]);
            result = gxp_divide_triangle(body, t, middle, divided);
        }
        if (result != GX_OK) return result;
        swap = blade->triangles;
        blade->triangles = *divided;
        *divided = swap;
        result = gxp_list_long_edges(blade, halved);
    }
    return result;
}

static gx_result gxp_push_cell(gx_body *body, void *user, uint32_t cell) {
    return gxp_push(body, (gxp_words *)user, cell);
}

/* Lists the cells whose deformed elements' boxes meet a box. The tree is up to date. */
static gx_result gxp_find_in_box(gx_body *body, const double low[3], const double high[3], gxp_words *found) {
    gxp_bounds box;
    memcpy(box.low, low, sizeof box.low);
    memcpy(box.high, high, sizeof box.high);
    found->count = 0;
    return gxp_walk_box(body, &box, gxp_push_cell, found);
}

/* Adds the cells that are inside the tool and not near its surface. */
static gx_result gxp_add_covered(gx_blade *blade, const gx_surface *tool) {
    gx_body *body = blade->body;
    double low[3], high[3];
    size_t i;
    gx_result result;
    memcpy(low, tool->vertices, sizeof low);
    memcpy(high, tool->vertices, sizeof high);
    for (i = 0; i < 3 * tool->vertex_count; i++) {
        low[i % 3] = fmin(low[i % 3], tool->vertices[i]);
        high[i % 3] = fmax(high[i % 3], tool->vertices[i]);
    }
    result = gxp_find_in_box(body, low, high, &blade->found);
    for (i = 0; i < blade->found.count && result == GX_OK; i++) {
        gxp_close_cell c;
        int on;
        c.cell = blade->found.data[i];
        c.quad = blade->quads.count / 4;
        if (gxp_close_index(&blade->near, c.cell) != GXP_NONE) continue;
        gxp_place_near(body, &c);
        if (gxb_winding_number(tool->vertices, tool->triangles, tool->triangle_count, c.middle, &on) != 0)
            result = gxp_push_near(blade, &c);
    }
    return result;
}

/* Finds the cells that the tool covers or is near, and their layers. */
static gx_result gxp_find_tool_layers(gx_blade *blade, const gx_surface *tool) {
    size_t i;
    gx_result result = GX_OK;
    blade->quads.count = 0;
    for (i = 0; i < tool->triangle_count && result == GX_OK; i++) {
        const uint32_t *t = tool->triangles + 3 * i;
        const double *a = tool->vertices + 3 * (size_t)t[0], *b = tool->vertices + 3 * (size_t)t[1],
                     *c = tool->vertices + 3 * (size_t)t[2];
        result = gxp_push_quad(blade, a, b, c, c);
    }
    if (result == GX_OK) result = gxp_find_near(blade, NULL);
    if (result == GX_OK) result = gxp_add_covered(blade, tool);
    if (result == GX_OK) result = gxp_number_layers(blade);
    return result == GX_OK ? gxp_order_near(blade) : result;
}

/* Does the tool come near the layer anywhere? */
static int gxp_meets_tool(const gx_blade *blade) {
    uint32_t i;
    for (i = 0; i < blade->samples.count; i++)
        if (blade->samples.data[i].distance < 0.5 * blade->samples.data[i].size) return 1;
    return 0;
}

/* The tool becomes a box around the whole body at rest: a layer that it covers wholly loses all. */
static gx_result gxp_take_all(gx_blade *blade) {
    static const uint32_t faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const gxp_box *all = &blade->body->mesh.boxes[0];
    uint32_t i, k;
    gx_result result = gxp_start_words(blade->body, &blade->triangles, 36);
    blade->samples.count = 0;
    for (i = 0; i < 8 && result == GX_OK; i++) {
        gxp_front_vertex v;
        memset(&v, 0, sizeof v);
        for (k = 0; k < 3; k++) v.rest[k] = i >> k & 1 ? all->high[k] + blade->largest : all->low[k] - blade->largest;
        result = gxp_push_vertex(blade->body, &blade->samples, &v);
    }
    if (result != GX_OK) return result;
    memcpy(blade->triangles.data, faces, sizeof faces);
    blade->triangles.count = 36;
    return GX_OK;
}

/* Adds the tool as a layer sees it to the surfaces of the cut. A layer that it does not come near is inside it, or not,
   as its first cell is. */
static gx_result gxp_add_tool(gx_blade *blade, uint32_t layer, const gx_surface *tool) {
    const gxp_vicinity *near = &blade->near;
    const uint32_t first = near->layer_start.data[layer];
    gx_body *body = blade->body;
    uint32_t i;
    int on;
    gx_result result = GX_OK;
    if (!gxp_meets_tool(blade)) {
        if (gxb_winding_number(tool->vertices, tool->triangles, tool->triangle_count,
                               near->cells[GXP_SECOND(near->order.data[first])].corners[0], &on) == 0)
            return GX_OK;
        result = gxp_take_all(blade);
    }
    if (result == GX_OK) result = gxp_push(body, &blade->surface_starts, blade->scope.count);
    if (result == GX_OK) result = gxp_push(body, &blade->surface_starts, blade->corners.count);
    for (i = first; i < near->layer_start.data[layer + 1] && result == GX_OK; i++)
        result = gxp_push(body, &blade->scope, body->cells.slot[near->cells[GXP_SECOND(near->order.data[i])].cell]);
    for (i = 0; i < blade->triangles.count && result == GX_OK; i++)
        result = gxp_push_point(body, &blade->corners, blade->samples.data[blade->triangles.data[i]].rest);
    return result;
}

static gx_result gxp_carve_layers(gx_blade *blade, const gx_surface *tool, gx_blade_report *report,
                                  gx_failure *failure) {
    uint32_t layer;
    gx_result result = gxp_refit_near(blade, 0, failure);
    if (result != GX_OK) return result;
    result = gxp_find_tool_layers(blade, tool);
    blade->surface_starts.count = blade->corners.count = blade->scope.count = 0;
    for (layer = 0; layer < blade->near.layer_count && result == GX_OK; layer++) {
        result = gxp_see_tool(blade, layer, tool);
        if (result == GX_OK) result = gxp_refine_tool(blade, layer);
        if (result == GX_OK) result = gxp_add_tool(blade, layer, tool);
    }
    if (gxp_end(failure, result) != GX_OK) return result;
    return gxp_cut_surfaces(blade, GX_SURFACE_SOLID, report, failure);
}

static gx_result gxp_check_tool(const gx_surface *tool, gx_failure *failure) {
    size_t i;
    if (tool->vertex_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "tool.vertex_count", SIZE_MAX);
    if (tool->triangle_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "tool.triangle_count", SIZE_MAX);
    if (tool->vertices == NULL) return gxp_refuse(failure, "tool.vertices");
    if (tool->triangles == NULL) return gxp_refuse(failure, "tool.triangles");
    if (tool->vertex_count > INT32_MAX / 4) return gxp_fail(failure, GX_ERROR_LIMIT, "tool.vertex_count", SIZE_MAX);
    if (tool->triangle_count > INT32_MAX / 12)
        return gxp_fail(failure, GX_ERROR_LIMIT, "tool.triangle_count", SIZE_MAX);
    for (i = 0; i < 3 * tool->vertex_count; i++) {
        if (!gxp_is_finite(tool->vertices[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "tool.vertices", i / 3);
        if (fabs(tool->vertices[i]) > ldexp(1, GXP_EDGE_REACH))
            return gxp_fail(failure, GX_ERROR_RANGE, "tool.vertices", i / 3);
    }
    for (i = 0; i < 3 * tool->triangle_count; i++)
        if (tool->triangles[i] >= tool->vertex_count) return gxp_fail(failure, GX_ERROR_INDEX, "tool.triangles", i / 3);
    return GX_OK;
}

GXFEM_API gx_result gx_body_carve(gx_body *body, const gx_surface *tool, gx_cut_report *report, gx_failure *failure) {
    gx_blade *blade;
    gx_blade_report own;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (tool == NULL) return gxp_refuse(failure, "tool");
    result = gxp_check_tool(tool, failure);
    if (result == GX_OK) result = gx_blade_create(body, NULL, &blade, failure);
    if (result != GX_OK) return result;
    gxp_clear_report(&own);
    result = gxp_carve_layers(blade, tool, &own, failure);
    gx_blade_destroy(blade);
    if (result == GX_OK && report != NULL) *report = own.cut;
    return result;
}

/* >>grid: a grid of elements around a shape ------------------------------------------------------------------------ */
/* In: closed surfaces and a resolution. Out: nodes and elements: all that the surfaces meet or wind around, and next to
   none else. The cubes' corners and middles are a body-centred lattice; an element lies between the middles of two
   cubes and two corners of the face between them. Exact winding numbers of nodes tell which elements are inside, so far
   as the surfaces do not come near them; those that they come near are found as a cut finds elements, and made. */

/* Nodes are named by their place in the arrays below: corners of cubes first, then middles. */
typedef struct gxp_grid {
    const gx_allocator *allocator;
    gxp_box all;             /* around the surfaces */
    double half, start[3];   /* m: half the edge of a cube; the lowest corner. Both have few bits: sums are exact */
    double unit;             /* a power of two, by which all is of about unit size */
    uint32_t size[3];        /* cubes by axis, one more than the surfaces reach on each side */
    uint32_t cubes, corners; /* their products */
    int32_t *winding;        /* by node: sums while a surface is counted; then the node's number */
    uint8_t *inside;         /* by node: 1 if a surface winds around it */
    uint16_t *made;          /* by cube: bits of its elements that are made, 4 x axis + quarter: see gxp_grid_element */
    uint32_t node_count, element_count;
} gxp_grid;

/* Larger grids would take more memory for their nodes than bodies can use for elements. */
#define GXP_GRID_CUBES 1e8
/* The surfaces stay that share of a cube within the grid's, so that no sliver of a further layer is made. */
#define GXP_GRID_MARGIN 0.0625

static void gxp_grid_free(gxp_grid *grid) {
    const size_t nodes = (size_t)grid->corners + grid->cubes;
    gxp_release(grid->allocator, grid->winding, nodes * sizeof *grid->winding);
    gxp_release(grid->allocator, grid->inside, nodes);
    gxp_release(grid->allocator, grid->made, grid->cubes * sizeof *grid->made);
    grid->winding = NULL;
    grid->inside = NULL;
    grid->made = NULL;
}

/* A positive number with 12 bits, not below x by more than its rounding */
static double gxp_few_bits(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = (bits + 0x1ffffffffffu) & ~(uint64_t)0x1ffffffffffu;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Places the grid around the surfaces, its cubes with edges of about h. */
static gx_result gxp_place_grid(gxp_grid *grid, double h, gx_failure *failure) {
    double far = 0, cubes = 1;
    int k, exponent;
    grid->half = gxp_few_bits(0.5 * h);
    for (k = 0; k < 3; k++) {
        const double layers = ceil((grid->all.high[k] - grid->all.low[k]) / (2 * grid->half) + 2 * GXP_GRID_MARGIN) + 2;
        cubes *= layers;
        if (!(cubes <= GXP_GRID_CUBES)) return gxp_fail(failure, GX_ERROR_LIMIT, "shape", SIZE_MAX);
        grid->size[k] = (uint32_t)layers;
        far = fmax(far, fmax(fabs(grid->all.low[k]), fabs(grid->all.high[k])) + layers * grid->half);
    }
    (void)frexp(far, &exponent);
    if (!(grid->half > ldexp(far, -36))) return gxp_fail(failure, GX_ERROR_RANGE, "shape", SIZE_MAX);
    for (k = 0; k < 3; k++) {
        const double middle = 0.5 * grid->all.low[k] + 0.5 * grid->all.high[k];
        grid->start[k] = ldexp(floor(ldexp(middle - grid->size[k] * grid->half, 40 - exponent)), exponent - 40);
    }
    grid->unit = ldexp(1, -exponent);
    grid->cubes = grid->size[0] * grid->size[1] * grid->size[2];
    grid->corners = (grid->size[0] + 1) * (grid->size[1] + 1) * (grid->size[2] + 1);
    return GX_OK;
}

static gx_result gxp_open_grid(gxp_grid *grid) {
    const size_t nodes = (size_t)grid->corners + grid->cubes;
    grid->winding = (int32_t *)gxp_allocate(grid->allocator, nodes * sizeof *grid->winding);
    grid->inside = (uint8_t *)gxp_allocate(grid->allocator, nodes);
    grid->made = (uint16_t *)gxp_allocate(grid->allocator, grid->cubes * sizeof *grid->made);
    if (grid->winding == NULL || grid->inside == NULL || grid->made == NULL) return GX_ERROR_MEMORY;
    memset(grid->winding, 0, nodes * sizeof *grid->winding);
    memset(grid->inside, 0, nodes);
    memset(grid->made, 0, grid->cubes * sizeof *grid->made);
    return GX_OK;
}

/* The coordinate of what is that many halves of a cube from the grid's lowest corner */
static double gxp_grid_at(const gxp_grid *grid, int axis, uint32_t halves) {
    return grid->start[axis] + grid->half * halves;
}

/* The node at these halves, which are all even or all odd */
static uint32_t gxp_grid_node(const gxp_grid *grid, const uint32_t halves[3]) {
    const uint32_t odd = halves[0] & 1, more = 1 - odd;
    return odd * grid->corners + halves[0] / 2 +
           (grid->size[0] + more) * (halves[1] / 2 + (grid->size[1] + more) * (halves[2] / 2));
}

/* One of the four elements across the face of a cube at its upper end along an axis, as halves of its nodes */
static void gxp_grid_element(const uint32_t cube[3], int axis, int quarter, uint32_t halves[4][3]) {
    static const uint8_t corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    int n;
    for (n = 0; n < 4; n++) {
        halves[n][axis] = 2 * cube[axis] + (n == 0 ? 1 : n == 1 ? 3 : 2);
        halves[n][u] = 2 * cube[u] + (n < 2 ? 1u : 2u * corner[quarter + n - 2][0]);
        halves[n][v] = 2 * cube[v] + (n < 2 ? 1u : 2u * corner[quarter + n - 2][1]);
    }
}

/* The side of the edge from a to b in the projection along x on which p is; p is moved by (h, h^2), h -> 0, so that it
   is on no edge. As rays in gxb_winding_number */
static int gxp_line_side(const double *a, const double *b, const double *p) {
    const int sign = gxb_orient2d(a + 1, b + 1, p + 1);
    if (sign != 0) return sign;
    return a[2] != b[2] ? (a[2] > b[2] ? 1 : -1) : b[1] > a[1] ? 1 : b[1] < a[1] ? -1 : 0;
}

/* Counts the crossing of a triangle with a line of nodes along x. line: halves of its first node */
static void gxp_cross_line(gxp_grid *grid, const double *a, const double *b, const double *c, uint32_t line[3]) {
    const uint32_t first = line[0] & 1;
    uint32_t low = 0, high = grid->size[0] + 1 - first;
    double p[3];
    int side;
    p[1] = gxp_grid_at(grid, 1, line[1]);
    p[2] = gxp_grid_at(grid, 2, line[2]);
    side = gxp_line_side(a, b, p);
    if (side == 0 || gxp_line_side(b, c, p) != side || gxp_line_side(c, a, p) != side) return;
    while (low < high) { /* nodes from which a ray along x crosses come before those from which none does */
        const uint32_t middle = low + (high - low) / 2;
        p[0] = gxp_grid_at(grid, 0, first + 2 * middle);
        if (gxb_orient3d(a, b, c, p) == side)
            low = middle + 1;
        else
            high = middle;
    }
    line[0] = first + 2 * (low - 1); /* the first node of a line is beside all surfaces */
    grid->winding[gxp_grid_node(grid, line)] += side;
    line[0] = first;
}

/* The places along an axis between two coordinates of surfaces, in halves of a cube, with the first beyond each: these
   are in the grid, which reaches farther by a cube. Coordinates are at most 2^36 halves: these are rounded by far less
   than 2^-6. */
static void gxp_grid_range(const gxp_grid *grid, int axis, double low, double high, uint32_t range[2]) {
    const double slack = 0.015625;
    range[0] = (uint32_t)floor((low - grid->start[axis]) / grid->half - slack);
    range[1] = (uint32_t)ceil((high - grid->start[axis]) / grid->half + slack);
}

/* Counts the crossings of a triangle with all lines of nodes along x. */
static void gxp_cross_lines(gxp_grid *grid, const gxp_search *search, const double *const p[3]) {
    uint32_t y[2], z[2], line[3];
    gxp_grid_range(grid, 1, search->low[1], search->high[1], y);
    gxp_grid_range(grid, 2, search->low[2], search->high[2], z);
    for (line[2] = z[0]; line[2] <= z[1]; line[2]++)
        for (line[1] = y[0] + ((y[0] ^ line[2]) & 1); line[1] <= y[1]; line[1] += 2) {
            line[0] = line[2] & 1;
            gxp_cross_line(grid, p[0], p[1], p[2], line);
        }
}

/* Marks the nodes around which a surface winds, whose crossings are counted: the sum of those from a node on. */
static void gxp_sum_lines(gxp_grid *grid) {
    uint32_t first = 0, odd, line, i;
    for (odd = 0; odd < 2; odd++) {
        const uint32_t count = grid->size[0] + 1 - odd, lines = (odd ? grid->cubes : grid->corners) / count;
        for (line = 0; line < lines; line++, first += count) {
            int32_t winding = 0;
            for (i = first + count; i-- > first;) {
                winding += grid->winding[i];
                grid->winding[i] = 0;
                if (winding != 0) grid->inside[i] = 1;
            }
        }
    }
}

/* Does a face of the tetrahedron have all corners of the triangle beyond it? With the tests of gxp_triangle_near_tet,
   these are all planes that can separate the two. x: as that has left it, from the triangle's base. */
static int gxp_triangle_beyond_face(const gxp_search *s, const double *const p[3], double x[3][4]) {
    double e[2][3], d[3], normal[3];
    int face, n, k;
    for (face = 0; face < 4; face++) {
        const uint8_t *out = gxp_outward[face];
        int beyond = 1;
        double scale;
        for (n = 0; n < 2; n++)
            for (k = 0; k < 3; k++) e[n][k] = x[k][out[n + 1]] - x[k][out[0]];
        scale = gxp_search_axis(e[0], e[1], normal);
        for (n = 0; n < 3 && beyond; n++) {
            gxp_search_vector(s, p[n], d);
            for (k = 0; k < 3; k++) d[k] -= x[k][out[0]];
            beyond = gxp_dot(normal, d) > GXP_SEARCH_MARGIN * scale * s->far;
        }
        if (beyond) return 1;
    }
    return 0;
}

/* Marks the elements across the upper face of a cube, along an axis, that the triangle may meet. */
static void gxp_mark_face(gxp_grid *grid, const gxp_search *search, const double *const p[3], const uint32_t cube[3],
                          int axis) {
    uint16_t *made = &grid->made[cube[0] + grid->size[0] * (cube[1] + grid->size[1] * cube[2])];
    uint32_t halves[4][3];
    double x[3][4];
    int quarter, n, k;
    for (quarter = 0; quarter < 4; quarter++) {
        gxp_grid_element(cube, axis, quarter, halves);
        for (n = 0; n < 4; n++)
            for (k = 0; k < 3; k++) x[k][n] = gxp_grid_at(grid, k, halves[n][k]);
        if (gxp_triangle_near_tet(search, x) && !gxp_triangle_beyond_face(search, p, x))
            *made |= (uint16_t)(1u << (4 * axis + quarter));
    }
}

/* Marks the elements that the triangle may meet: of an axis those between two middles along it and, along the other
   axes, in the cubes that it reaches. */
static void gxp_mark_elements(gxp_grid *grid, const gxp_search *search, const double *const p[3]) {
    uint32_t range[3][2], low[3], high[3], cube[3];
    int axis, k;
    for (k = 0; k < 3; k++) gxp_grid_range(grid, k, search->low[k], search->high[k], range[k]);
    for (axis = 0; axis < 3; axis++) {
        for (k = 0; k < 3; k++) {
            const uint32_t reach = k == axis ? 3 : 2;
            low[k] = range[k][0] > reach ? (range[k][0] - reach + 1) / 2 : 0;
            high[k] = (range[k][1] - (k == axis)) / 2;
        }
        for (cube[2] = low[2]; cube[2] <= high[2]; cube[2]++)
            for (cube[1] = low[1]; cube[1] <= high[1]; cube[1]++)
                for (cube[0] = low[0]; cube[0] <= high[0]; cube[0]++) {
                    gxp_box box;
                    for (k = 0; k < 3; k++) {
                        box.low[k] = gxp_grid_at(grid, k, 2 * cube[k]);
                        box.high[k] = gxp_grid_at(grid, k, 2 * cube[k] + (k == axis ? 4 : 2));
                    }
                    if (gxp_triangle_near_box(search, &box)) gxp_mark_face(grid, search, p, cube, axis);
                }
    }
}

static void gxp_enter_surface(gxp_grid *grid, const gx_surface *s) {
    gxp_search search;
    size_t t;
    int k;
    for (t = 0; t < s->triangle_count; t++) {
        const double *p[3];
        for (k = 0; k < 3; k++) p[k] = s->vertices + 3 * (size_t)s->triangles[3 * t + (size_t)k];
        gxp_search_init(&search, p, grid->unit, &grid->all);
        gxp_cross_lines(grid, &search, p);
        gxp_mark_elements(grid, &search, p);
    }
    gxp_sum_lines(grid);
}

/* Makes all elements of a cube whose middle is inside: what the surfaces do not come near has it as a node. */
static void gxp_make_inner(gxp_grid *grid) {
    uint32_t i;
    for (i = 0; i < grid->cubes; i++)
        if (grid->inside[grid->corners + i]) grid->made[i] = 0xfff;
}

/* Numbers the nodes of an element that is made in the order in which they are met. */
static void gxp_number_nodes(gxp_grid *grid, const uint32_t cube[3], int axis, int quarter, uint32_t nodes[4]) {
    uint32_t halves[4][3];
    int n;
    gxp_grid_element(cube, axis, quarter, halves);
    for (n = 0; n < 4; n++) {
        int32_t *number = &grid->winding[gxp_grid_node(grid, halves[n])];
        if (*number < 0) *number = (int32_t)grid->node_count++;
        nodes[n] = (uint32_t)*number;
    }
}

/* Walks through the elements that are made, cube by cube. Counts them and their nodes, which get numbers. elements:
   written unless NULL. lacking: NULL, or for each element of the same walk before, 1 if it is not to be made */
static void gxp_list_elements(gxp_grid *grid, uint32_t *elements, const uint8_t *lacking) {
    uint32_t cube[3], nodes[4];
    size_t i = 0, before = 0;
    int bit;
    memset(grid->winding, 0xff, ((size_t)grid->corners + grid->cubes) * sizeof *grid->winding);
    grid->node_count = grid->element_count = 0;
    for (cube[2] = 0; cube[2] < grid->size[2]; cube[2]++)
        for (cube[1] = 0; cube[1] < grid->size[1]; cube[1]++)
            for (cube[0] = 0; cube[0] < grid->size[0]; cube[0]++, i++)
                for (bit = 0; bit < 12 && grid->made[i] != 0; bit++) {
                    if (!(grid->made[i] >> bit & 1)) continue;
                    if (lacking != NULL && lacking[before++]) {
                        grid->made[i] = (uint16_t)(grid->made[i] & ~(1u << bit));
                        continue;
                    }
                    gxp_number_nodes(grid, cube, bit / 4, bit % 4, nodes);
                    if (elements != NULL) memcpy(elements + 4 * (size_t)grid->element_count, nodes, sizeof nodes);
                    grid->element_count++;
                }
}

/* Makes a grid with edges of about h of the surfaces: which elements are made. gxp_grid_free frees it, also after an
   error. */
static gx_result gxp_make_grid(gxp_grid *grid, double h, const gx_cut_desc *cut, gx_failure *failure) {
    size_t i;
    gx_result result = gxp_place_grid(grid, h, failure);
    if (result != GX_OK) return result;
    result = gxp_open_grid(grid);
    for (i = 0; i < cut->surface_count && result == GX_OK; i++) gxp_enter_surface(grid, &cut->surfaces[i]);
    if (result == GX_OK) {
        gxp_make_inner(grid);
        gxp_list_elements(grid, NULL, NULL);
    }
    return gxp_end(failure, result);
}

/* The edge of cubes of which so many stand along the longest side */
static double gxp_edge_of_cells(const gxp_grid *grid, uint32_t cells) {
    double longest = 0;
    int k;
    for (k = 0; k < 3; k++) longest = fmax(longest, grid->all.high[k] - grid->all.low[k]);
    return longest / (cells - 2 * GXP_GRID_MARGIN);
}

/* Finds the most cells along the longest side with which the nodes have no more unknowns than allowed: a grid of twice
   as many has about eight times the nodes. Makes that grid. */
static gx_result gxp_meet_budget(gxp_grid *grid, size_t unknowns, const gx_cut_desc *cut, gx_failure *failure) {
    uint32_t enough = 0, many = 0, cells = 1;
    gx_result result;
    for (;;) {
        result = gxp_make_grid(grid, gxp_edge_of_cells(grid, cells), cut, failure);
        if (result != GX_OK && result != GX_ERROR_LIMIT) return result;
        if (result == GX_OK && 3 * (size_t)grid->node_count <= unknowns) {
            if (many == cells + 1) return GX_OK;
            enough = cells;
        } else
            many = cells;
        gxp_grid_free(grid);
        if (enough == 0) return gxp_fail(failure, GX_ERROR_LIMIT, "shape.unknowns", SIZE_MAX);
        cells = many == 0 ? 2 * enough : many == enough + 1 ? enough : enough + (many - enough) / 2;
    }
}

static gx_result gxp_choose_grid(gxp_grid *grid, const gx_body_desc *desc, const gx_cut_desc *cut,
                                 gx_failure *failure) {
    const gx_shape *shape = desc->shape;
    const gx_surface *s;
    size_t i;
    gx_result result;
    memset(grid, 0, sizeof *grid);
    grid->allocator = &desc->allocator;
    memcpy(grid->all.low, cut->surfaces[0].vertices, sizeof grid->all.low);
    memcpy(grid->all.high, cut->surfaces[0].vertices, sizeof grid->all.high);
    for (s = cut->surfaces; s < cut->surfaces + cut->surface_count; s++)
        for (i = 0; i < 3 * s->vertex_count; i++) {
            grid->all.low[i % 3] = fmin(grid->all.low[i % 3], s->vertices[i]);
            grid->all.high[i % 3] = fmax(grid->all.high[i % 3], s->vertices[i]);
        }
    result =
        shape->unknowns > 0
            ? gxp_meet_budget(grid, shape->unknowns, cut, failure)
            : gxp_make_grid(grid, shape->cells > 0 ? gxp_edge_of_cells(grid, shape->cells) : shape->edge, cut, failure);
    if (result != GX_OK) gxp_grid_free(grid);
    return result;
}

/* Takes the elements without cells out of the grid: the surfaces only touch them. *lacks: 1 if there were some */
static gx_result gxp_drop_elements(gxp_grid *grid, const gx_body *body, int *lacks) {
    uint8_t *lacking = (uint8_t *)gxp_allocate(grid->allocator, grid->element_count);
    const uint32_t count = grid->element_count;
    uint32_t i;
    if (lacking == NULL) return GX_ERROR_MEMORY;
    *lacks = 0;
    memset(lacking, 1, count);
    for (i = 0; i < body->view.count; i++) lacking[body->view.element[i]] = 0;
    for (i = 0; i < count && !*lacks; i++) *lacks = lacking[i];
    if (*lacks) gxp_list_elements(grid, NULL, lacking);
    gxp_release(grid->allocator, lacking, count);
    return GX_OK;
}

/* Writes the grid's nodes and elements. */
static void gxp_fill_grid(gxp_grid *grid, double *positions, uint32_t *elements) {
    uint32_t halves[3], odd, k;
    gxp_list_elements(grid, elements, NULL);
    for (odd = 0; odd < 2; odd++)
        for (halves[2] = odd; halves[2] <= 2 * grid->size[2]; halves[2] += 2)
            for (halves[1] = odd; halves[1] <= 2 * grid->size[1]; halves[1] += 2)
                for (halves[0] = odd; halves[0] <= 2 * grid->size[0]; halves[0] += 2) {
                    const int32_t number = grid->winding[gxp_grid_node(grid, halves)];
                    for (k = 0; k < 3 && number >= 0; k++)
                        positions[3 * (size_t)number + k] = gxp_grid_at(grid, (int)k, halves[k]);
                }
}

/* What the checks of a cut's surfaces name, as members of the description */
static gx_result gxp_name_shape(gx_failure *failure, gx_result result) {
    static const char *const names[][2] = {{"surfaces.vertices", "shape.surfaces.vertices"},
                                           {"surfaces.triangles", "shape.surfaces.triangles"},
                                           {"surfaces.vertex_count", "shape.surfaces.vertex_count"},
                                           {"surfaces.triangle_count", "shape.surfaces.triangle_count"},
                                           {"surfaces.material", "shape.surfaces.material"},
                                           {"surfaces.texture", "shape.surfaces.texture"}};
    size_t i;
    if (result == GX_OK || failure == NULL || failure->field == NULL) return result;
    for (i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(failure->field, names[i][0]) == 0) {
            failure->field = names[i][1];
            break;
        }
    return result;
}

static gx_result gxp_check_shape_surface(const gx_surface *s, size_t materials, gx_failure *failure) {
    const double most = ldexp(1, GXP_REACH);
    gx_surface plain = *s;
    size_t i;
    gx_result result;
    plain.kind = GX_SURFACE_KEEP;
    result = gxp_check_surface_arrays(&plain, failure);
    for (i = 0; i < 3 * s->vertex_count && result == GX_OK; i++) {
        if (!gxp_is_finite(s->vertices[i]))
            result = gxp_fail(failure, GX_ERROR_NOT_FINITE, "surfaces.vertices", i / 3);
        else if (fabs(s->vertices[i]) > most)
            result = gxp_fail(failure, GX_ERROR_RANGE, "surfaces.vertices", i / 3);
    }
    for (i = 0; i < 3 * s->triangle_count && result == GX_OK; i++)
        if (s->triangles[i] >= s->vertex_count) result = gxp_fail(failure, GX_ERROR_INDEX, "surfaces.triangles", i / 3);
    if (result == GX_OK && s->material >= materials)
        result = gxp_fail(failure, GX_ERROR_INDEX, "surfaces.material", SIZE_MAX);
    return gxp_name_shape(failure, result);
}

/* All but whether the surfaces are closed, which the cut checks */
static gx_result gxp_check_shape(const gx_body_desc *desc, gx_failure *failure) {
    const gx_shape *shape = desc->shape;
    const size_t materials = desc->materials != NULL ? desc->material_count : 1;
    size_t i;
    gx_result result = GX_OK;
    if (shape->surfaces == NULL) return gxp_refuse(failure, "shape.surfaces");
    if (shape->surface_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "shape.surface_count", SIZE_MAX);
    if (!gxp_is_finite(shape->edge)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "shape.edge", SIZE_MAX);
    if (shape->edge < 0) return gxp_refuse(failure, "shape.edge");
    if ((shape->cells > 0) + (shape->edge > 0) + (shape->unknowns > 0) != 1) return gxp_refuse(failure, "shape.cells");
    for (i = 0; i < shape->surface_count && result == GX_OK; i++) {
        result = gxp_check_shape_surface(&shape->surfaces[i], materials, failure);
        if (result != GX_OK && failure != NULL) failure->surface = i;
    }
    return result;
}

/* >>create: create and destroy ------------------------------------------------------------------------------------- */
/* In: a description. Out: a body with one cell for each element and one copy for each node that an element uses. After
   an error everything made so far is destroyed. */

#define GXP_AFFINE_MOST 1e3 /* of affine_below: all is thinner than that */

/* Blames a node that is too far out, or all if the body is too small. */
static gx_result gxp_check_size(const gx_body_desc *desc, gx_failure *failure) {
    const double most = ldexp(1, GXP_REACH);
    double longest = 0;
    size_t i;
    int k;
    for (k = 0; k < 3; k++) {
        double low = desc->positions[k], high = low;
        for (i = 0; i < desc->node_count; i++) {
            const double x = desc->positions[3 * i + (size_t)k];
            if (fabs(x) > most) return gxp_fail(failure, GX_ERROR_RANGE, "positions", i);
            if (x < low) low = x;
            if (x > high) high = x;
        }
        if (high - low > longest) longest = high - low;
    }
    return longest < 1 / most ? gxp_fail(failure, GX_ERROR_RANGE, "positions", SIZE_MAX) : GX_OK;
}

/* An element of positive volume may have none in doubles. */
static gx_result gxp_check_volume(const gx_body *body, uint32_t element, double volume) {
    if (volume <= 0 || gxp_rounds_inverted(body, element)) return GX_ERROR_FLAT;
    return gxp_is_mass(volume * gxp_density(body, &body->cells.data[element])) ? GX_OK : GX_ERROR_RANGE;
}

/* Blames an element that is flat, too heavy or too light. */
static gx_result gxp_make_first_cells(gx_body *body, gx_failure *failure) {
    gx_result result = GX_OK;
    uint32_t e;
    body->cells.count = body->slots.count = body->leaves.count = body->mesh.element_count;
    for (e = 0; e < body->mesh.element_count; e++) {
        gxp_cell *cell = &body->cells.data[e];
        memset(cell, 0, sizeof *cell);
        cell->element = cell->first_leaf = e;
        body->cells.slot[e] = body->slots.parent[e] = e;
        memcpy(cell->copies, gxb_complex_element_nodes(body->complex, e), sizeof cell->copies);
        cell->next = GXP_NONE;
        cell->kept = 1;
        cell->material = body->mesh.element_materials[e] & INT32_MAX;
        cell->volume = gxp_element_volume(body, e);
        result = gxp_check_volume(body, e, cell->volume);
        if (result != GX_OK) return gxp_fail(failure, result, "elements", e);
        gxi_tet_mass(cell->volume, gxp_density(body, cell), cell->mass);
        memset(&body->leaves.data[e], 0, sizeof body->leaves.data[e]);
        body->leaves.data[e].cell = e;
        body->leaves.data[e].next = GXP_NONE;
    }
    return GX_OK;
}

/* Copies are numbered over the nodes that elements use; others have none. */
static void gxp_make_first_copies(gx_body *body) {
    gxp_copies *copies = &body->copies;
    uint32_t i, e;
    int k;
    copies->count = 0;
    for (i = 0; i < body->mesh.node_count; i++) {
        if (body->mesh.node_start[i] == body->mesh.node_start[i + 1]) continue;
        for (e = body->mesh.node_start[i]; e < body->mesh.node_start[i + 1]; e++) {
            k = gxp_local_node(body, body->mesh.node_elements[e], i);
            body->cells.data[body->mesh.node_elements[e]].copies[k] = copies->count;
        }
        copies->node[copies->count++] = i;
    }
    memset(copies->displacement, 0, 3 * (size_t)copies->count * sizeof(double));
    memset(copies->velocity, 0, 3 * (size_t)copies->count * sizeof(double));
    memset(copies->rest_time, 0, copies->count * sizeof(double));
    memset(copies->held, 0, copies->count);
    memset(copies->label, 0, copies->count * sizeof *copies->label);
    memset(copies->before, 0, copies->count * sizeof *copies->before);
}

/* Columns of affine copies, all 0 */
static gx_result gxp_make_affine_columns(gx_body *body) {
    gx_result result = GX_OK;
    int i;
    for (i = 0; i < GXP_AFFINE_COLUMNS && result == GX_OK && body->config.affine_below > 0; i++)
        result = gxp_make_column(body, &gxp_copy_columns[GXP_FIRST_AFFINE + i], body->mesh.node_count);
    return result;
}

/* Makes the arrays of fixed size and the first rows of those that grow. */
static gx_result gxp_make_tables(gx_body *body, const gx_body_desc *desc) {
    const size_t nodes = body->mesh.node_count;
    gx_result result = gxp_make_rows(body, GXP_NODES, nodes + 1);
    if (result == GX_OK) result = gxp_make_rows(body, GXP_ELEMENTS, (size_t)body->mesh.element_count + 1);
    if (result == GX_OK) result = gxp_make_rows(body, GXP_EDGES, body->mesh.edge_count);
    if (result == GX_OK) result = gxp_make_rows(body, GXP_MATERIALS, body->mesh.material_count);
    if (result == GX_OK && desc->texture != NULL)
        result = gxp_make_column(body, &gxp_node_columns[GXP_TEXTURE_COLUMN], nodes);
    if (result == GX_OK && gxp_is_mixed(body))
        result = gxp_make_column(body, &gxp_view_columns[GXP_VIEWED_MATERIALS], body->mesh.element_count);
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_CELLS, body->mesh.element_count);
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_SLOTS, body->mesh.element_count);
    if (result == GX_OK) result = gxp_grow_rows(body, GXP_LEAVES, body->mesh.element_count);
    return result == GX_OK ? gxp_grow_rows(body, GXP_COPIES, nodes) : result;
}

static gx_result gxp_create_solver(gx_body *body) {
    gxs_solver_desc solver;
    memset(&solver, 0, sizeof solver);
    solver.allocator = body->config.allocator;
    solver.jobs = body->config.jobs;
    return gxs_solver_create(&solver, &body->solver, NULL);
}

static void gxp_fill_materials(gx_body *body, const gx_body_desc *desc) {
    if (desc->materials != NULL)
        memcpy(body->mesh.materials, desc->materials, body->mesh.material_count * sizeof *body->mesh.materials);
    else {
        body->mesh.materials->elastic.young = desc->young;
        body->mesh.materials->elastic.poisson = desc->poisson;
        body->mesh.materials->density = desc->density;
    }
    if (desc->materials != NULL && desc->element_materials != NULL)
        memcpy(body->mesh.element_materials, desc->element_materials, body->mesh.element_count * sizeof(uint32_t));
}

static uint64_t gxp_hash_mesh(const gx_body *body) {
    const uint64_t hash = gxp_hash_texture(
        gxp_hash_doubles(gxp_mix(body->mesh.node_count), body->mesh.positions, 3 * (size_t)body->mesh.node_count),
        body->mesh.texture, body->mesh.node_count);
    return gxp_hash_doubles(gxp_hash_words(gxp_hash_words(hash, gxb_complex_element_nodes(body->complex, 0),
                                                          4 * (size_t)body->mesh.element_count),
                                           body->mesh.element_materials, body->mesh.element_count),
                            &body->config.support_below, 1);
}

static gx_result gxp_fill_body(gx_body *body, const gx_body_desc *desc, gx_failure *failure) {
    gxp_mesh *mesh = &body->mesh;
    gx_result result = gxp_check_size(desc, failure);
    if (result == GX_OK) result = gxp_make_tables(body, desc);
    if (result == GX_OK) result = gxp_create_solver(body);
    if (result != GX_OK) return result;
    memcpy(mesh->positions, desc->positions, 3 * (size_t)mesh->node_count * sizeof(double));
    gxp_fill_materials(body, desc);
    if (mesh->texture != NULL) memcpy(mesh->texture, desc->texture, 2 * (size_t)mesh->node_count * sizeof(float));
    gxp_list_node_elements(body);
    result = gxp_find_pinched_nodes(body);
    gxp_find_pinched_edges(body);
    if (result == GX_OK) result = gxp_make_first_cells(body, failure);
    if (result != GX_OK) return result;
    gxp_make_first_copies(body);
    gxp_build_boxes(body);
    result = gxp_make_affine_columns(body);
    if (result == GX_OK) result = gxp_first_sheets(body);
    if (result != GX_OK) return result;
    body->view.stale = 1;
    body->model.state = GXP_MODEL_STALE;
    body->cuts.hash = gxp_hash_mesh(body);
    if (body->config.affine_below > 0)
        body->cuts.hash = gxp_hash_doubles(body->cuts.hash, &body->config.affine_below, 1);
    return gxp_first_snapshot(body);
}

/* names: of young, poisson, density */
static gx_result gxp_check_material(double young, double poisson, double density, const char *const names[3],
                                    size_t index, gx_failure *failure) {
    const double numbers[3] = {young, poisson, density};
    int k;
    for (k = 0; k < 3; k++) {
        if (!gxp_is_finite(numbers[k])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, names[k], index);
        if (k == 1 ? poisson < 0 || poisson >= 0.5 : numbers[k] <= 0)
            return gxp_fail(failure, GX_ERROR_ARGUMENT, names[k], index);
    }
    return GX_OK;
}

/* One of the materials; of the elastic constants what gxp_check_material does not know */
static gx_result gxp_check_elastic(const gxs_material *m, size_t index, gx_failure *failure) {
    if ((int)m->kind < 0 || m->kind > GXS_CUSTOM)
        return gxp_fail(failure, GX_ERROR_ARGUMENT, "materials.elastic.kind", index);
    if (!gxp_is_finite(m->damping)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "materials.elastic.damping", index);
    if (m->damping < 0) return gxp_fail(failure, GX_ERROR_ARGUMENT, "materials.elastic.damping", index);
    if (m->kind == GXS_CUSTOM && m->energy == NULL)
        return gxp_fail(failure, GX_ERROR_ARGUMENT, "materials.elastic.energy", index);
    return GX_OK;
}

static gx_result gxp_check_materials(const gx_body_desc *desc, gx_failure *failure) {
    static const char *const names[3] = {"young", "poisson", "density"}, *const elastic[3] = {
                                                                             "materials.elastic.young",
                                                                             "materials.elastic.poisson",
                                                                             "materials.density"};
    gx_result result = GX_OK;
    size_t i;
    if (desc->materials == NULL) {
        if (desc->material_count > 0 || desc->element_materials != NULL) return gxp_refuse(failure, "materials");
        return gxp_check_material(desc->young, desc->poisson, desc->density, names, SIZE_MAX, failure);
    }
    if (desc->material_count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "material_count", SIZE_MAX);
    if (desc->material_count >= INT32_MAX) return gxp_fail(failure, GX_ERROR_LIMIT, "material_count", SIZE_MAX);
    for (i = 0; i < desc->material_count && result == GX_OK; i++) {
        const gxs_material *m = &desc->materials[i].elastic;
        result = gxp_check_material(m->young, m->poisson, desc->materials[i].density, elastic, i, failure);
        if (result == GX_OK) result = gxp_check_elastic(m, i, failure);
    }
    for (i = 0; i < desc->element_count && result == GX_OK && desc->element_materials != NULL; i++)
        if (desc->element_materials[i] >= desc->material_count)
            result = gxp_fail(failure, GX_ERROR_INDEX, "element_materials", i);
    return result;
}

/* All but the mesh, which the complex checks */
static gx_result gxp_check_body_desc(const gx_body_desc *desc, gx_failure *failure) {
    size_t i;
    if (!gxb_is_allocator(&desc->allocator)) return gxp_refuse(failure, "allocator");
    if (!gxp_is_finite(desc->support_below)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "support_below", SIZE_MAX);
    if (desc->support_below < 0 || desc->support_below >= 1) return gxp_refuse(failure, "support_below");
    if (!gxp_is_finite(desc->affine_below)) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "affine_below", SIZE_MAX);
    if (desc->affine_below < 0 || desc->affine_below > GXP_AFFINE_MOST) return gxp_refuse(failure, "affine_below");
    if (desc->shape != NULL) {
        if (desc->positions != NULL || desc->node_count > 0) return gxp_refuse(failure, "positions");
        if (desc->elements != NULL || desc->element_count > 0) return gxp_refuse(failure, "elements");
        if (desc->element_materials != NULL) return gxp_refuse(failure, "element_materials");
        if (desc->texture != NULL) return gxp_refuse(failure, "texture");
    }
    for (i = 0; i < 2 * desc->node_count && desc->texture != NULL; i++)
        if (!gxp_is_finite((double)desc->texture[i])) return gxp_fail(failure, GX_ERROR_NOT_FINITE, "texture", i / 2);
    return gxp_check_materials(desc, failure);
}

/* Copies the caller's settings and puts defaults in the place of zeros. */
static void gxp_set_config(gxp_config *config, const gx_body_desc *desc) {
    config->allocator = desc->allocator;
    config->jobs = desc->jobs;
    config->clock = desc->clock;
    config->clock_user = desc->clock_user;
    config->support_below = desc->support_below;
    config->affine_below = desc->affine_below;
    config->follow_below = desc->support_below > 0 ? desc->support_below : GXP_SUPPORT;
    config->speck_below = desc->support_below > 0 ? desc->support_below : GXP_SPECK;
    config->speck_reach = desc->support_below > 0 ? 0 : GXP_SPECK_REACH;
}

GXFEM_API void gx_body_destroy(gx_body *body) {
    gx_allocator a;
    uint32_t t;
    if (body == NULL) return;
    a = body->config.allocator;
    for (t = 0; t < GXP_TABLES; t++) gxp_release_columns(body, gxp_tables[t].columns, gxp_tables[t].column_count);
    gxp_release_columns(body, gxp_lists, sizeof gxp_lists / sizeof *gxp_lists);
    gxp_release_model(body);
    gxs_solver_destroy(body->solver);
    gxb_complex_destroy(body->complex);
    while (body->blades != NULL) gx_blade_destroy(body->blades);
    gxp_release(&a, body, sizeof *body);
}

/* Creates a body of a mesh. The description is checked. */
static gx_result gxp_create_of_mesh(const gx_body_desc *desc, gx_body **out, gx_failure *failure) {
    gx_body *body;
    gxb_mesh mesh;
    gx_result result;
    body = (gx_body *)gxp_allocate(&desc->allocator, sizeof *body);
    if (body == NULL) return gxp_end(failure, GX_ERROR_MEMORY);
    memset(body, 0, sizeof *body);
    gxp_set_config(&body->config, desc);
    mesh.positions = desc->positions;
    mesh.node_count = desc->node_count;
    mesh.elements = desc->elements;
    mesh.element_count = desc->element_count;
    result = gxb_complex_create(&mesh, &desc->allocator, &body->complex, failure);
    if (result != GX_OK) {
        gx_body_destroy(body);
        return result;
    }
    body->mesh.node_count = gxb_complex_node_count(body->complex);
    body->mesh.element_count = gxb_complex_element_count(body->complex);
    body->mesh.edge_count = gxb_complex_mesh_edge_count(body->complex);
    body->mesh.material_count = desc->materials != NULL ? (uint32_t)desc->material_count : 1;
    result = gxp_fill_body(body, desc, failure);
    if (gxp_close(failure, result) != GX_OK) {
        gx_body_destroy(body);
        return result;
    }
    *out = body;
    return GX_OK;
}

/* Leaves of a body of a grid what the shape's surfaces wind around. It begins as a body without a past view. */
static gx_result gxp_carve_shape(gx_body *body, const gx_cut_desc *desc, gx_failure *failure) {
    gxp_cut cut;
    gx_result result;
    memset(&cut, 0, sizeof cut);
    cut.body = body;
    cut.desc = desc;
    cut.shapes = 1;
    result = gxp_run_cut(&cut, NULL, failure);
    if (result != GX_OK) return gxp_name_shape(failure, result);
    result = gxp_first_snapshot(body);
    if (result == GX_OK && body->view.count == 0) return gxp_fail(failure, GX_ERROR_EMPTY, "shape.surfaces", SIZE_MAX);
    return gxp_end(failure, result);
}

/* Makes a body of a grid and carves the shape out of it. */
static gx_result gxp_create_of_grid(const gx_body_desc *desc, gxp_grid *grid, const gx_cut_desc *cut, gx_body **body,
                                    gx_failure *failure) {
    const gx_allocator *a = &desc->allocator;
    gx_body_desc meshed = *desc;
    double *positions = (double *)gxp_allocate(a, 3 * (size_t)grid->node_count * sizeof *positions);
    uint32_t *elements = (uint32_t *)gxp_allocate(a, 4 * (size_t)grid->element_count * sizeof *elements);
    gx_result result = GX_ERROR_MEMORY;
    if (positions != NULL && elements != NULL) {
        gxp_fill_grid(grid, positions, elements);
        meshed.shape = NULL;
        meshed.positions = positions;
        meshed.node_count = grid->node_count;
        meshed.elements = elements;
        meshed.element_count = grid->element_count;
        result = gxp_create_of_mesh(&meshed, body, failure);
    } else
        gxp_end(failure, result);
    gxp_release(a, positions, 3 * (size_t)grid->node_count * sizeof *positions);
    gxp_release(a, elements, 4 * (size_t)grid->element_count * sizeof *elements);
    return result == GX_OK ? gxp_carve_shape(*body, cut, failure) : result;
}

/* Chooses the grid. Where surfaces only touch elements, these turn out to be empty, and the body is made without. */
static gx_result gxp_create_carved(const gx_body_desc *desc, const gx_cut_desc *cut, gx_body **out,
                                   gx_failure *failure) {
    gx_body *body = NULL;
    gxp_grid grid;
    int lacks = 0;
    gx_result result = gxp_choose_grid(&grid, desc, cut, failure);
    if (result != GX_OK) return result;
    do {
        gx_body_destroy(body);
        body = NULL;
        result = gxp_create_of_grid(desc, &grid, cut, &body, failure);
        if (result == GX_OK) result = gxp_end(failure, gxp_drop_elements(&grid, body, &lacks));
    } while (result == GX_OK && lacks);
    gxp_grid_free(&grid);
    if (result == GX_OK)
        *out = body;
    else
        gx_body_destroy(body);
    return result;
}

/* Creates a body of a shape. Its surfaces cut at once, as solids that keep. */
static gx_result gxp_create_of_shape(const gx_body_desc *desc, gx_body **out, gx_failure *failure) {
    const size_t count = desc->shape->surface_count;
    gx_surface *surfaces;
    gx_cut_desc cut;
    size_t i;
    gx_result result = gxp_check_shape(desc, failure);
    if (result != GX_OK) return result;
    surfaces = (gx_surface *)gxp_allocate(&desc->allocator, count * sizeof *surfaces);
    if (surfaces == NULL) return gxp_end(failure, GX_ERROR_MEMORY);
    memcpy(surfaces, desc->shape->surfaces, count * sizeof *surfaces);
    for (i = 0; i < count; i++) {
        surfaces[i].kind = GX_SURFACE_KEEP;
        surfaces[i].scope_slots = NULL;
        surfaces[i].scope_slot_count = 0;
    }
    memset(&cut, 0, sizeof cut);
    cut.surfaces = surfaces;
    cut.surface_count = count;
    result = gxp_create_carved(desc, &cut, out, failure);
    gxp_release(&desc->allocator, surfaces, count * sizeof *surfaces);
    return result;
}

GXFEM_API gx_result gx_body_create(const gx_body_desc *desc, gx_body **out, gx_failure *failure) {
    gx_result result;
    if (desc == NULL) return gxp_refuse(failure, "desc");
    if (out == NULL) return gxp_refuse(failure, "body");
    result = gxp_check_body_desc(desc, failure);
    if (result != GX_OK) return result;
    return desc->shape != NULL ? gxp_create_of_shape(desc, out, failure) : gxp_create_of_mesh(desc, out, failure);
}

/* >>hashes: of the topology, of the state -------------------------------------------------------------------------- */
/* In: a body. Out: hashes, equal for equal bodies. The topology's does not depend on any order or rounding. */

#define GXP_BESIDE_WALL 0xfffffff0u /* neighbour across a wall inside the element */
#define GXP_ACROSS_WALL 0xfffffff1u /* neighbour across a wall on a face */
#define GXP_BESIDE_OPEN 0xfffffff2u /* neighbour across an interface inside the element */

/* Appends to pairs (face or kind, neighbour) for everything around a cell. */
static gx_result gxp_push_neighbours(gx_body *body, uint32_t cell, gxp_keys *pairs) {
    gxb_complex *cx = body->complex;
    const uint32_t element = body->cells.data[cell].element;
    uint32_t leaf, first, count, i;
    gx_result result = gxb_complex_open_element(cx, element);
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next) {
        result = gxb_leaf_resolve_facets(cx, leaf, &first, &count);
        for (i = 0; i < count && result == GX_OK; i++) {
            const gxb_facet *f = gxb_complex_facet(cx, gxp_item(cx, first + i));
            const uint32_t other = f->leaf[f->leaf[0] == leaf];
            if (!gxp_is_kept(body, other) || body->leaves.data[other].cell == cell) continue;
            result = gxp_push_key(body, pairs,
                                  f->face == GXB_NONE ? f->wall ? GXP_BESIDE_WALL : GXP_BESIDE_OPEN
                                  : f->wall           ? GXP_ACROSS_WALL
                                                      : f->face,
                                  body->leaves.data[other].cell);
        }
    }
    return result;
}

static uint64_t gxp_hash_neighbours(const gxp_keys *pairs, const uint64_t *name) {
    uint64_t sum = 0;
    uint32_t i;
    for (i = 0; i < pairs->count; i++) {
        const uint64_t pair = pairs->data[i];
        if (i == 0 || pair != pairs->data[i - 1]) sum += gxp_mix(name[GXP_SECOND(pair)] ^ gxp_mix(GXP_FIRST(pair)));
    }
    return sum;
}

/* The first name of a cell: the nodes of the element that it contains */
static gx_result gxp_first_name(gx_body *body, uint32_t cell, uint64_t *name) {
    uint32_t leaf, i, mask = 0;
    gx_result result = GX_OK;
    for (leaf = body->cells.data[cell].first_leaf; leaf != GXP_NONE && result == GX_OK;
         leaf = body->leaves.data[leaf].next) {
        result = gxp_collect_leaf_points(body, leaf);
        for (i = 0; i < body->scratch.leaf_points.count; i++) {
            const int k = gxp_local_node(body, body->cells.data[cell].element, body->scratch.leaf_points.data[i]);
            if (k >= 0) mask |= 1u << k;
        }
    }
    *name = gxp_mix((uint64_t)body->cells.data[cell].element << 4 | mask);
    return result;
}

/* Three rounds in which each cell's name takes in its neighbours' names (Weisfeiler-Lehman). Sums do not depend on any
   order. */
static gx_result gxp_name_cells(gx_body *body, uint64_t *name, uint64_t *next) {
    const gxp_view *view = &body->view;
    gxp_keys pairs = {NULL, 0, 0};
    uint32_t i, round;
    gx_result result = GX_OK;
    for (i = 0; i < view->count && result == GX_OK; i++)
        result = gxp_first_name(body, view->cell[i], &name[view->cell[i]]);
    for (round = 0; round < 3 && result == GX_OK; round++) {
        for (i = 0; i < view->count && result == GX_OK; i++) {
            const uint32_t cell = view->cell[i];
            pairs.count = 0;
            result = gxp_push_neighbours(body, cell, &pairs);
            if (result == GX_OK) result = gxp_sort_keys(body, &pairs, 0, pairs.count);
            next[cell] = gxp_mix(name[cell] * 3 + gxp_hash_neighbours(&pairs, name));
        }
        memcpy(name, next, body->cells.count * sizeof *name);
    }
    gxp_release(&body->config.allocator, pairs.data, pairs.capacity * sizeof *pairs.data);
    return result;
}

/* The cells with their names, the copies that they share, the counts */
static uint64_t gxp_hash_names(const gx_body *body, const uint64_t *name, uint64_t *copies) {
    uint64_t sum = gxp_mix(body->copies.count) + gxp_mix((uint64_t)body->view.fragment_count << 32);
    uint32_t i, k;
    memset(copies, 0, body->copies.count * sizeof *copies);
    for (i = 0; i < body->view.count; i++) {
        const uint32_t cell = body->view.cell[i];
        sum += gxp_mix(name[cell]);
        for (k = 0; k < 4; k++) copies[body->cells.data[cell].copies[k]] += gxp_mix(name[cell] + k);
    }
    for (i = 0; i < body->copies.count; i++) sum += gxp_mix(copies[i] ^ gxp_mix(body->copies.node[i]));
    return sum;
}

GXFEM_API uint64_t gx_body_topology_hash(gx_body *body, gx_failure *failure) {
    gx_result r;
    uint64_t *names, hash = 0;
    size_t words;
    if (body == NULL) {
        gxp_refuse(failure, "body");
        return 0;
    }
    words = 2 * (size_t)body->cells.count + body->copies.count;
    r = gxp_update_view(body);
    names = (uint64_t *)gxp_allocate(&body->config.allocator, words * sizeof *names);
    if (r == GX_OK && names == NULL) r = GX_ERROR_MEMORY;
    if (r == GX_OK) {
        memset(names, 0, words * sizeof *names);
        r = gxp_name_cells(body, names, names + body->cells.count);
        if (r == GX_OK) hash = gxp_hash_names(body, names, names + 2 * (size_t)body->cells.count);
    }
    gxp_release(&body->config.allocator, names, words * sizeof *names);
    return gxp_end(failure, r) == GX_OK ? hash : 0;
}

static uint64_t gxp_hash_blade(uint64_t hash, const gxp_blade_state *b) {
    size_t i;
    hash = gxp_hash_bytes(hash, (const unsigned char *)b->vertices.data, b->vertices.count * sizeof *b->vertices.data);
    hash = gxp_hash_doubles(hash, b->points.data, 3 * (size_t)b->points.count);
    hash = gxp_hash_bytes(hash, (const unsigned char *)b->layers.data, b->layers.count * sizeof *b->layers.data);
    for (i = 0; i < b->members.count; i++) hash = gxp_mix(hash ^ b->members.data[i]);
    hash = gxp_hash_doubles(gxp_mix(hash ^ b->slot_count), b->edge.data, 3 * (size_t)b->edge.count);
    if (!b->glance.ready) return hash;
    for (i = 0; i < b->glance.beads.count; i++) {
        const gxp_bead *bead = &b->glance.beads.data[i];
        hash = gxp_hash_bytes(hash, (const unsigned char *)bead, sizeof *bead);
    }
    hash = gxp_hash_doubles(hash, &b->glance.travelled, 1);
    return gxp_hash_doubles(hash, b->glance.edge.data, 3 * (size_t)b->glance.edge.count);
}

/* Does a blade of the body leave out moves? */
static int gxp_has_glances(const gx_body *body) {
    const gx_blade *blade;
    for (blade = body->blades; blade != NULL; blade = blade->next)
        if (blade->now.glance.ready) return 1;
    return 0;
}

GXFEM_API uint64_t gx_body_state_hash(const gx_body *body) {
    const uint32_t use = GXP_TOPOLOGY | GXP_STATE | (body->copies.previous_dt > 0 ? (uint32_t)GXP_HISTORY : 0) |
                         (gxp_has_glances(body) ? (uint32_t)GXP_STROKE : 0) |
                         (body->copies.affine != NULL ? (uint32_t)GXP_AFFINE : 0);
    uint64_t hash = gxp_mix(body->cuts.epoch ^ (uint64_t)body->snapshot.next_id << 32);
    const gx_blade *blade;
    uint32_t t, i;
    for (t = 0; t < GXP_TABLES; t++) {
        const size_t rows = gxp_count(body, t);
        for (i = 0; i < gxp_tables[t].column_count; i++) {
            const gxp_column *column = &gxp_tables[t].columns[i];
            if (column->use & use)
                hash = gxp_hash_bytes(hash, (const unsigned char *)gxp_array_at(body, column), rows * column->size);
        }
    }
    for (i = 0; i < gxb_complex_leaf_count(body->complex); i++)
        hash = gxp_mix(hash ^ gxb_complex_leaf(body->complex, i)->removed);
    for (blade = body->blades; blade != NULL; blade = blade->next) hash = gxp_hash_blade(hash, &blade->now);
    return body->touch.pressed != 0 ? gxp_mix(hash ^ body->touch.pressed) : hash;
}

GXFEM_API const char *gx_result_text(gx_result result) {
    switch (result) {
    case GX_OK: return "no error";
    case GX_ERROR_ARGUMENT: return "a required value is missing, or it is out of its range";
    case GX_ERROR_MEMORY: return "out of memory";
    case GX_ERROR_NOT_FINITE: return "a number is not finite";
    case GX_ERROR_RANGE: return "a number is too large or too small";
    case GX_ERROR_INDEX: return "an index is out of range";
    case GX_ERROR_EMPTY: return "nothing is there: no elements, nodes, triangles, or no copy in a region";
    case GX_ERROR_INVERTED: return "an element is inverted (negative volume)";
    case GX_ERROR_FLAT: return "an element is flat (no volume)";
    case GX_ERROR_OVERLAP: return "elements overlap: a face is shared by more than two elements, or by two on one side";
    case GX_ERROR_NOT_CLOSED: return "a solid's surface is not closed or not consistently oriented";
    case GX_ERROR_LIMIT: return "too many objects, or a memory limit is reached";
    case GX_ERROR_DIVERGED: return "the time step diverged";
    case GX_ERROR_FREE: return "nothing holds a component in a static balance";
    case GX_ERROR_FORMAT: return "not a saved body, or one of another version or kind of machine";
    case GX_ERROR_DAMAGED: return "a saved body is damaged";
    case GX_ERROR_STALE: return "copies are named as they were before a cut";
    case GX_ERROR_CONFIGURATION: return "floating-point arithmetic is not what exact predicates need";
    case GX_ERROR_SEQUENCE: return "called too early or too late: another call must come before";
    case GX_ERROR_CAPACITY: return "the array or memory for the answer is too small";
    }
    return "unknown result";
}

/* >>stream: a body as bytes: head, mesh, topology ------------------------------------------------------------------ */
/* One stream of bytes serves save, load, clone and restore; a clone is written to memory and read back without the
   checks. In: a body, or bytes. Out: bytes, or a body. What is written and read follows from the lists at >>columns:
   topology (beside gxb_complex_save) here, all else in the next section. */

static void gxp_require(gxb_stream *s, gx_result result) {
    if (s->result == GX_OK) s->result = result;
}
static void gxp_require_true(gxb_stream *s, int holds) {
    if (!holds) gxp_require(s, GX_ERROR_DAMAGED);
}
static void gxp_pass_word(gxb_stream *s, uint32_t *word) { gxb_stream_pass(s, word, 1, sizeof *word); }

#define GXP_SAVE_VERSION 12u /* raised by every change of the format */
#define GXP_BYTE_ORDER   0x01020304u

typedef struct gxp_head {
    unsigned char magic[8];
    uint32_t version, order;
    double width;            /* -2.5: doubles are IEEE 754's */
    uint64_t size, checksum; /* of all bytes; of those after the head */
} gxp_head;

/* shows if a transfer treated it as text */
static const unsigned char gxp_magic[8] = {'g', 'x', 'f', 'e', 'm', '\r', '\n', 0x1a};

static void gxp_pass_head(gxb_stream *s, gxp_head *head) {
    gxb_stream_pass(s, head->magic, 8, 1);
    gxp_pass_word(s, &head->version);
    gxp_pass_word(s, &head->order);
    gxb_stream_pass(s, &head->width, 1, sizeof head->width);
    gxb_stream_pass(s, &head->size, 1, sizeof head->size);
    gxb_stream_pass(s, &head->checksum, 1, sizeof head->checksum);
}

static gxp_head gxp_make_head(uint64_t size, uint64_t checksum) {
    gxp_head head;
    memcpy(head.magic, gxp_magic, sizeof head.magic);
    head.version = GXP_SAVE_VERSION;
    head.order = GXP_BYTE_ORDER;
    head.width = -2.5;
    head.size = size;
    head.checksum = checksum;
    return head;
}

static gx_result gxp_check_head(gxb_stream *s) {
    gxp_head head, own;
    gxp_pass_head(s, &head);
    own = gxp_make_head(head.size, head.checksum);
    if (memcmp(head.magic, own.magic, sizeof own.magic) != 0 || head.version != own.version ||
        head.order != own.order || memcmp(&head.width, &own.width, sizeof own.width) != 0)
        return GX_ERROR_FORMAT;
    if (s->result != GX_OK || head.size != s->size) return GX_ERROR_DAMAGED;
    return head.checksum == gxp_hash_bytes(0, s->in + s->at, s->size - s->at) ? GX_OK : GX_ERROR_DAMAGED;
}

static void gxp_pass_material(gxb_stream *s, gx_material *m) {
    uint32_t kind = (uint32_t)m->elastic.kind;
    gxp_pass_word(s, &kind);
    gxp_require_true(s, kind <= (uint32_t)GXS_CUSTOM);
    if (s->result == GX_OK) m->elastic.kind = (gxs_material_kind)kind;
    gxb_stream_pass(s, &m->elastic.young, 1, sizeof(double));
    gxb_stream_pass(s, &m->elastic.poisson, 1, sizeof(double));
    gxb_stream_pass(s, &m->elastic.damping, 1, sizeof(double));
    gxb_stream_pass(s, &m->density, 1, sizeof(double));
}

typedef struct gxp_saved_mesh {
    uint32_t node_count, element_count, material_count;
    double support_below, affine_below;
    uint32_t textured; /* 1: there is a texture */
    double *positions;
    float *texture;
    uint32_t *elements, *element_materials;
    gx_material *materials;
} gxp_saved_mesh;

static void gxp_pass_sizes(gxb_stream *s, gxp_saved_mesh *mesh) {
    gxp_pass_word(s, &mesh->node_count);
    gxp_pass_word(s, &mesh->element_count);
    gxp_pass_word(s, &mesh->material_count);
    gxp_pass_word(s, &mesh->textured);
    gxb_stream_pass(s, &mesh->support_below, 1, sizeof mesh->support_below);
    gxb_stream_pass(s, &mesh->affine_below, 1, sizeof mesh->affine_below);
}

static void gxp_pass_mesh(gxb_stream *s, gxp_saved_mesh *mesh) {
    uint32_t i;
    gxb_stream_pass(s, mesh->positions, 3 * (size_t)mesh->node_count, sizeof(double));
    if (mesh->textured) gxb_stream_pass(s, mesh->texture, 2 * (size_t)mesh->node_count, sizeof(float));
    gxb_stream_pass(s, mesh->elements, 4 * (size_t)mesh->element_count, sizeof(uint32_t));
    gxb_stream_pass(s, mesh->element_materials, mesh->element_count, sizeof(uint32_t));
    for (i = 0; i < mesh->material_count; i++) gxp_pass_material(s, &mesh->materials[i]);
}

static void gxp_save_mesh(gxb_stream *s, gx_body *body) {
    gxp_saved_mesh mesh;
    mesh.node_count = body->mesh.node_count;
    mesh.element_count = body->mesh.element_count;
    mesh.material_count = body->mesh.material_count;
    mesh.support_below = body->config.support_below;
    mesh.affine_below = body->config.affine_below;
    mesh.positions = body->mesh.positions;
    mesh.elements = (uint32_t *)gxb_complex_element_nodes(body->complex, 0); /* only written from here */
    mesh.texture = body->mesh.texture;
    mesh.textured = body->mesh.texture != NULL;
    mesh.element_materials = body->mesh.element_materials;
    mesh.materials = body->mesh.materials;
    gxp_pass_sizes(s, &mesh);
    gxp_pass_mesh(s, &mesh);
}

/* Energies are not saved: the caller gives them again. */
static gx_result gxp_give_energies(gxp_saved_mesh *mesh, const gx_body_desc *desc, gx_failure *failure) {
    uint32_t i;
    for (i = 0; i < mesh->material_count; i++) {
        gxs_material *m = &mesh->materials[i].elastic;
        if (m->kind != GXS_CUSTOM) continue;
        if (desc->materials == NULL || i >= desc->material_count || desc->materials[i].elastic.energy == NULL)
            return gxp_fail(failure, GX_ERROR_ARGUMENT, "materials.elastic.energy", i);
        m->energy = desc->materials[i].elastic.energy;
        m->user = desc->materials[i].elastic.user;
    }
    return GX_OK;
}

/* Creates the uncut body of the mesh. */
static void gxp_create_again(gxb_stream *s, const gx_body_desc *given, gxp_saved_mesh *mesh, gx_body **body,
                             gx_failure *failure) {
    gx_body_desc desc;
    gx_result result;
    gxp_pass_mesh(s, mesh);
    if (s->result != GX_OK) return;
    gxp_require(s, gxp_give_energies(mesh, given, failure));
    if (s->result != GX_OK) return;
    memset(&desc, 0, sizeof desc);
    desc.allocator = given->allocator;
    desc.clock = given->clock;
    desc.clock_user = given->clock_user;
    desc.jobs = given->jobs;
    desc.positions = mesh->positions;
    desc.node_count = mesh->node_count;
    desc.elements = mesh->elements;
    desc.element_count = mesh->element_count;
    desc.materials = mesh->materials;
    desc.material_count = mesh->material_count;
    desc.element_materials = mesh->element_materials;
    desc.texture = mesh->textured ? mesh->texture : NULL;
    desc.support_below = mesh->support_below;
    desc.affine_below = mesh->affine_below;
    result = gx_body_create(&desc, body, NULL);
    gxp_require(s, result == GX_OK || result == GX_ERROR_MEMORY || result == GX_ERROR_LIMIT ||
                           result == GX_ERROR_CONFIGURATION
                       ? result
                       : GX_ERROR_DAMAGED);
}

/* Reads the mesh and creates the body from it. */
static void gxp_load_mesh(gxb_stream *s, const gx_body_desc *desc, gx_body **body, gx_failure *failure) {
    const gx_allocator *a = &desc->allocator;
    size_t positions, texture, elements, element_materials, materials;
    gxp_saved_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    gxp_pass_sizes(s, &mesh);
    gxb_stream_has(s, mesh.node_count, 3 * sizeof(double));
    gxb_stream_has(s, mesh.element_count, 5 * sizeof(uint32_t));
    gxb_stream_has(s, mesh.material_count, sizeof(uint32_t) + 4 * sizeof(double));
    gxp_require_true(s, mesh.node_count > 0 && mesh.element_count > 0 && mesh.material_count > 0 &&
                            mesh.material_count <= INT32_MAX / sizeof(gx_material) && mesh.textured <= 1);
    if (s->result != GX_OK) return;
    positions = 3 * (size_t)mesh.node_count * sizeof(double);
    elements = 4 * (size_t)mesh.element_count * sizeof(uint32_t);
    texture = 2 * (size_t)mesh.node_count * sizeof(float);
    element_materials = elements / 4;
    materials = mesh.material_count * sizeof(gx_material);
    mesh.positions = (double *)gxp_allocate(a, positions);
    mesh.texture = (float *)gxp_allocate(a, texture);
    mesh.elements = (uint32_t *)gxp_allocate(a, elements);
    mesh.element_materials = (uint32_t *)gxp_allocate(a, element_materials);
    mesh.materials = (gx_material *)gxp_allocate(a, materials);
    if (mesh.positions && mesh.texture && mesh.elements && mesh.element_materials && mesh.materials) {
        memset(mesh.materials, 0, materials);
        gxp_create_again(s, desc, &mesh, body, failure);
    } else
        gxp_require(s, GX_ERROR_MEMORY);
    gxp_release(a, mesh.positions, positions);
    gxp_release(a, mesh.texture, texture);
    gxp_release(a, mesh.elements, elements);
    gxp_release(a, mesh.element_materials, element_materials);
    gxp_release(a, mesh.materials, materials);
}

/* Passes the row counts of the tables that have columns of that use. */
static void gxp_pass_counts(gxb_stream *s, uint32_t use, uint32_t counts[GXP_TABLES]) {
    uint32_t t;
    for (t = 0; t < GXP_TABLES; t++)
        if (gxp_row_size(t, use) > 0) gxp_pass_word(s, &counts[t]);
}

static void gxp_count_rows(const gx_body *body, uint32_t counts[GXP_TABLES]) {
    uint32_t t;
    for (t = 0; t < GXP_TABLES; t++) counts[t] = gxp_count(body, t);
}

/* Reading: checks that there are bytes for these rows, and that indices can name them. */
static void gxp_check_counts(gxb_stream *s, uint32_t use, const uint32_t counts[GXP_TABLES]) {
    uint32_t t;
    for (t = 0; t < GXP_TABLES; t++) {
        if (gxp_row_size(t, use) == 0) continue;
        gxb_stream_has(s, counts[t], gxp_row_size(t, use));
        gxp_require_true(s, counts[t] <= INT32_MAX);
    }
}

/* Room for these rows; the present ones stay. */
static gx_result gxp_rows_room(gx_body *body, uint32_t use, const uint32_t counts[GXP_TABLES]) {
    uint32_t t;
    gx_result result = GX_OK;
    for (t = 0; t < GXP_TABLES && result == GX_OK; t++)
        if (gxp_row_size(t, use) > 0 && counts[t] > gxp_count(body, t))
            result = gxp_grow_rows(body, t, counts[t] - gxp_count(body, t));
    return result;
}

/* Passes the columns of that use. When reading there is room, and the tables get that many rows. */
static void gxp_pass_rows(gxb_stream *s, gx_body *body, uint32_t use, const uint32_t counts[GXP_TABLES]) {
    uint32_t t, i;
    for (t = 0; t < GXP_TABLES; t++) {
        if (gxp_row_size(t, use) == 0) continue;
        if (s->in != NULL) *gxp_count_at(body, t) = counts[t];
        for (i = 0; i < gxp_tables[t].column_count; i++) {
            const gxp_column *column = &gxp_tables[t].columns[i];
            if (column->use & use) gxb_stream_pass(s, gxp_array_at(body, column), counts[t], column->size);
        }
    }
}

static void gxp_pass_topology(gxb_stream *s, gx_body *body, const uint32_t counts[GXP_TABLES]) {
    gxp_pass_rows(s, body, GXP_TOPOLOGY, counts);
    gxp_pass_word(s, &body->cuts.label_count);
    gxb_stream_pass(s, &body->cuts.hash, 1, sizeof body->cuts.hash);
    gxb_stream_pass(s, &body->cuts.epoch, 1, sizeof body->cuts.epoch);
}

static void gxp_save_topology(gxb_stream *s, gx_body *body) {
    uint32_t counts[GXP_TABLES];
    gxp_count_rows(body, counts);
    gxb_complex_save(body->complex, s);
    gxp_pass_counts(s, GXP_TOPOLOGY, counts);
    gxp_pass_topology(s, body, counts);
}

/* One byte for each cell, leaf and copy: 1 if it has been met */
typedef struct gxp_places {
    unsigned char *cell, *leaf, *copy;
} gxp_places;

/* The cell's leaves are kept, in its element and in no other cell; its copies are those of its element's nodes. It is
   no larger than the element; a factor of 2 allows for rounding. */
static void gxp_check_cell(gxb_stream *s, gx_body *body, uint32_t cell, const gxp_places *seen) {
    gxp_cell *c = &body->cells.data[cell];
    const uint32_t *node = gxb_complex_element_nodes(body->complex, c->element);
    const double most = 2 * gxp_element_volume(body, c->element);
    double density;
    uint32_t leaf, k;
    gxp_require_true(s, (c->first_leaf != GXP_NONE) == c->kept && c->material < body->mesh.material_count);
    if (s->result != GX_OK) return;
    density = gxp_density(body, c);
    for (leaf = c->first_leaf; leaf != GXP_NONE && s->result == GX_OK; leaf = body->leaves.data[leaf].next) {
        gxp_require_true(s, leaf < body->leaves.count && !seen->leaf[leaf < body->leaves.count ? leaf : 0]);
        if (s->result != GX_OK) return;
        seen->leaf[leaf] = 1;
        gxp_require_true(s, body->leaves.data[leaf].cell == cell && gxp_is_kept(body, leaf) &&
                                gxb_complex_leaf(body->complex, leaf)->element == c->element);
    }
    gxp_require_true(s, gxp_is_finite(c->volume) && c->volume >= 0 && c->volume <= most);
    for (k = 0; k < 10; k++) gxp_require_true(s, gxp_is_finite(c->mass[k]) && fabs(c->mass[k]) <= most * density);
    for (k = 0; k < 4 && s->result == GX_OK; k++) {
        if (!c->kept) {
            gxp_require_true(s, c->copies[k] == GXP_NONE);
            continue;
        }
        gxp_require_true(s, c->copies[k] < body->copies.count &&
                                body->copies.node[c->copies[k] < body->copies.count ? c->copies[k] : 0] == node[k]);
        if (s->result == GX_OK) seen->copy[c->copies[k]] = 1;
    }
}

/* The cell's name is that of its element, or one of a later cell. It comes from a cell of its element, if that is
   still there. */
static int gxp_is_named(const gx_body *body, uint32_t cell) {
    const uint32_t slot = body->cells.slot[cell], element = body->cells.data[cell].element;
    uint32_t parent;
    if (cell == element) return slot == cell;
    if (slot <= body->cells.slot[cell - 1] || slot >= body->slots.count) return 0;
    parent = gxp_cell_of_slot(body, body->slots.parent[slot]);
    return parent == GXP_NONE || body->cells.data[parent].element == element;
}

/* Every cell is in its element's list once, every kept leaf in one kept cell, and every copy moves a cell. */
static void gxp_check_lists(gxb_stream *s, gx_body *body, const gxp_places *seen) {
    uint32_t e, i, cell;
    for (e = 0; e < body->mesh.element_count; e++)
        for (cell = e; cell != GXP_NONE && s->result == GX_OK; cell = body->cells.data[cell].next) {
            gxp_require_true(s, cell < body->cells.count && !seen->cell[cell < body->cells.count ? cell : 0]);
            if (s->result != GX_OK) return;
            seen->cell[cell] = 1;
            gxp_require_true(s, body->cells.data[cell].element == e && gxp_is_named(body, cell));
            if (s->result == GX_OK) gxp_check_cell(s, body, cell, seen);
        }
    for (i = 0; i < body->cells.count; i++) gxp_require_true(s, seen->cell[i]);
    for (i = 0; i < body->slots.count; i++) /* an element's first cell is its own parent */
        gxp_require_true(s, i < body->mesh.element_count ? body->slots.parent[i] == i : body->slots.parent[i] < i);
    for (i = 0; i < body->copies.count; i++) gxp_require_true(s, seen->copy[i]);
    for (i = 0; i < body->leaves.count; i++) {
        gxp_require_true(s, body->leaves.data[i].cell < body->cells.count &&
                                seen->leaf[i] == !gxb_complex_leaf(body->complex, i)->removed);
        gxp_require_true(s, seen->leaf[i] || body->leaves.data[i].next == GXP_NONE);
    }
    for (i = 0; i < gxb_complex_label_count(body->complex); i++)
        gxp_require_true(s, gxb_complex_label(body->complex, i)->triangle < body->cuts.label_count);
}

/* Surfaces are in the order of their labels; each has maps for all of its triangles or for none. */
static void gxp_check_surfaces(gxb_stream *s, const gx_body *body) {
    uint32_t i;
    size_t k;
    for (i = 0; i < body->cuts.surface_count; i++) {
        const gxp_surface_record *r = &body->cuts.surfaces[i];
        const uint32_t end = i + 1 < body->cuts.surface_count ? r[1].label : body->cuts.label_count;
        gxp_require_true(s, r->label < end && (i > 0 || r->label == 0));
        gxp_require_true(s, r->map == GXP_NONE ||
                                (r->map <= body->cuts.map_count && end - r->label <= body->cuts.map_count - r->map));
    }
    gxp_require_true(s, body->cuts.surface_count > 0 || body->cuts.label_count == 0);
    for (k = 0; k < 8 * (size_t)body->cuts.map_count; k++) gxp_require_true(s, gxp_is_finite(body->cuts.maps[k]));
}

static void gxp_check_topology(gxb_stream *s, gx_body *body) {
    const size_t bytes = (size_t)body->cells.count + body->leaves.count + body->copies.count;
    gxp_places seen;
    seen.cell = (unsigned char *)gxp_allocate(&body->config.allocator, bytes);
    if (seen.cell == NULL) {
        gxp_require(s, GX_ERROR_MEMORY);
        return;
    }
    memset(seen.cell, 0, bytes);
    seen.leaf = seen.cell + body->cells.count;
    seen.copy = seen.leaf + body->leaves.count;
    gxp_check_lists(s, body, &seen);
    gxp_check_surfaces(s, body);
    gxp_release(&body->config.allocator, seen.cell, bytes);
}

static void gxp_load_topology(gxb_stream *s, gx_body *body, int trusted) {
    uint32_t counts[GXP_TABLES];
    (void)gxb_complex_load(body->complex, s, trusted);
    gxp_pass_counts(s, GXP_TOPOLOGY, counts);
    gxp_check_counts(s, GXP_TOPOLOGY, counts);
    gxp_require_true(s, counts[GXP_CELLS] >= body->mesh.element_count && counts[GXP_SLOTS] >= counts[GXP_CELLS] &&
                            counts[GXP_LEAVES] == gxb_complex_leaf_count(body->complex));
    if (s->result == GX_OK) gxp_require(s, gxp_rows_room(body, GXP_TOPOLOGY, counts));
    if (s->result != GX_OK) return;
    gxp_pass_topology(s, body, counts);
    if (body->copies.count > 0) memset(body->copies.held, 0, body->copies.count);
    if (s->result == GX_OK && !trusted) gxp_check_topology(s, body);
    body->holds.stale = body->view.stale = 1;
    body->model.state = GXP_MODEL_STALE;
    body->view.labels_known = 0;
}

/* >>scabbard: blades as bytes -------------------------------------------------------------------------------------- */
/* In: a body's blades, or bytes. Out: bytes, or blades that go on as the others do. Touches blade.now, and blade.then
   where a body takes over the blades of another. */

/* One blade: what it remembers. n: the counts of its lists, which have room for them if it is read. */
enum {
    GXP_BLADE_VERTICES,
    GXP_BLADE_POINTS,
    GXP_BLADE_LAYERS,
    GXP_BLADE_MEMBERS,
    GXP_BLADE_EDGE,
    GXP_BLADE_BEADS,
    GXP_BLADE_GLANCE,
    GXP_BLADE_LISTS
};

static void gxp_pass_blade_head(gxb_stream *s, gx_blade *blade, uint32_t n[GXP_BLADE_LISTS]) {
    uint32_t inside = (uint32_t)blade->starts_inside;
    gxb_stream_pass(s, &blade->tolerance, 1, sizeof blade->tolerance);
    gxb_stream_pass(s, &blade->min_advance, 1, sizeof blade->min_advance);
    gxp_pass_word(s, &blade->max_samples);
    gxp_pass_word(s, &inside);
    gxp_pass_word(s, &blade->now.slot_count);
    gxb_stream_pass(s, blade->now.middle, 3, sizeof(double));
    gxp_pass_word(s, &blade->now.glance.ready);
    gxb_stream_pass(s, &blade->now.glance.travelled, 1, sizeof(double));
    gxb_stream_pass(s, &blade->now.glance.room, 1, sizeof(double));
    gxb_stream_pass(s, &blade->now.glance.course, 1, sizeof(double));
    gxb_stream_pass(s, &blade->now.glance.cut, 1, sizeof(uint64_t));
    gxb_stream_pass(s, n, GXP_BLADE_LISTS, sizeof *n);
    blade->starts_inside = inside != 0;
}

static void gxp_pass_blade(gxb_stream *s, gxp_blade_state *b) {
    uint32_t i;
    for (i = 0; i < b->vertices.count; i++) {
        gxp_front_vertex *v = &b->vertices.data[i];
        uint32_t flags;
        gxb_stream_pass(s, v->rest, 3, sizeof *v->rest);
        gxb_stream_pass(s, v->extended, 3, sizeof *v->extended);
        gxb_stream_pass(s, v->position, 3, sizeof *v->position);
        gxb_stream_pass(s, v->foot, 3, sizeof *v->foot);
        gxb_stream_pass(s, v->foot_at, 3, sizeof *v->foot_at);
        gxb_stream_pass(s, v->ahead, 3, sizeof *v->ahead);
        gxb_stream_pass(s, &v->distance, 1, sizeof v->distance);
        gxb_stream_pass(s, &v->size, 1, sizeof v->size);
        gxb_stream_pass(s, &v->along, 1, sizeof v->along);
        gxp_pass_word(s, &v->element);
        flags = (uint32_t)v->soft | (uint32_t)v->gap << 1 | (uint32_t)v->walled << 2;
        gxp_pass_word(s, &flags);
        v->soft = flags & 1;
        v->gap = flags >> 1 & 1;
        v->walled = flags >> 2 & 1;
        v->unused = 0;
    }
    gxb_stream_pass(s, b->points.data, 3 * (size_t)b->points.count, sizeof(double));
    gxb_stream_pass(s, b->layers.data, sizeof(gxp_layer) / sizeof(uint32_t) * (size_t)b->layers.count,
                    sizeof(uint32_t));
    gxb_stream_pass(s, b->members.data, b->members.count, sizeof(uint64_t));
    gxb_stream_pass(s, b->edge.data, 3 * (size_t)b->edge.count, sizeof(double));
    for (i = 0; i < b->glance.beads.count; i++) {
        gxp_bead *bead = &b->glance.beads.data[i];
        gxb_stream_pass(s, &bead->along, 1, sizeof bead->along);
        gxb_stream_pass(s, bead->rest, 3, sizeof *bead->rest);
        gxb_stream_pass(s, bead->axis, 3, sizeof *bead->axis);
        gxb_stream_pass(s, bead->slope, 3, sizeof *bead->slope);
        gxb_stream_pass(s, &bead->radius, 1, sizeof bead->radius);
        gxb_stream_pass(s, &bead->farthest, 1, sizeof bead->farthest);
        gxp_pass_word(s, &bead->cell);
        bead->unused = 0;
    }
    gxb_stream_pass(s, b->glance.edge.data, 3 * (size_t)b->glance.edge.count, sizeof(double));
}

static void gxp_save_blades(gxb_stream *s, gx_body *body) {
    uint32_t count = 0;
    gx_blade *b;
    for (b = body->blades; b != NULL; b = b->next) count++;
    gxp_pass_word(s, &count);
    for (b = body->blades; b != NULL; b = b->next) {
        uint32_t n[GXP_BLADE_LISTS];
        n[GXP_BLADE_VERTICES] = b->now.vertices.count;
        n[GXP_BLADE_POINTS] = b->now.points.count;
        n[GXP_BLADE_LAYERS] = b->now.layers.count;
        n[GXP_BLADE_MEMBERS] = b->now.members.count;
        n[GXP_BLADE_EDGE] = b->now.edge.count;
        n[GXP_BLADE_BEADS] = b->now.glance.beads.count;
        n[GXP_BLADE_GLANCE] = b->now.glance.edge.count;
        gxp_pass_blade_head(s, b, n);
        gxp_pass_blade(s, &b->now);
    }
}

static int gxp_are_finite(const double *x, size_t count) {
    size_t i;
    for (i = 0; i < count; i++)
        if (!gxp_is_finite(x[i])) return 0;
    return 1;
}

static void gxp_check_vertex(gxb_stream *s, const gx_body *body, const gxp_front_vertex *v) {
    gxp_require_true(s, v->element < body->mesh.element_count && v->along >= 0 && v->along <= UINT32_MAX &&
                            v->distance >= 0 && v->size >= 0);
    gxp_require_true(s, gxp_are_finite(v->rest, 3) && gxp_are_finite(v->extended, 3) &&
                            gxp_are_finite(v->position, 3) && gxp_are_finite(v->foot, 3) &&
                            gxp_are_finite(v->foot_at, 3) && gxp_are_finite(v->ahead, 3) && gxp_is_finite(v->size));
}

static int gxp_is_range(uint32_t first, uint32_t count, uint32_t all) { return first <= all && count <= all - first; }

/* What a move relies on: ranges within their lists, members in order */
static void gxp_check_strokes(gxb_stream *s, const gx_body *body, const gx_blade *blade) {
    const gxp_blade_state *b = &blade->now;
    uint32_t i;
    gxp_require_true(s, gxp_is_finite(blade->tolerance) && blade->tolerance > 0 && gxp_is_finite(blade->min_advance) &&
                            blade->min_advance > 0 && b->slot_count <= body->slots.count && b->edge.count != 1);
    for (i = 0; i < b->vertices.count; i++) gxp_check_vertex(s, body, &b->vertices.data[i]);
    gxp_require_true(s, gxp_are_finite(b->points.data, 3 * (size_t)b->points.count) &&
                            gxp_are_finite(b->edge.data, 3 * (size_t)b->edge.count));
    for (i = 0; i < b->layers.count; i++) {
        const gxp_layer *l = &b->layers.data[i];
        gxp_require_true(s, l->front_count != 1 && l->latest_count != 1 &&
                                gxp_is_range(l->front, l->front_count, b->vertices.count) &&
                                gxp_is_range(l->latest, l->latest_count, b->vertices.count) &&
                                gxp_is_range(l->seen, l->seen_count, b->vertices.count) &&
                                gxp_is_range(l->path, l->path_count, b->points.count) &&
                                gxp_is_range(l->sheet, l->sheet_count, b->points.count));
    }
    for (i = 0; i < b->members.count; i++)
        gxp_require_true(s, GXP_FIRST(b->members.data[i]) < b->slot_count &&
                                GXP_SECOND(b->members.data[i]) < b->layers.count &&
                                (i == 0 || b->members.data[i - 1] < b->members.data[i]));
}

/* What moves that are left out rely on: one blade of a body leaves them out. After a cut, beads are not used. */
static void gxp_check_glance(gxb_stream *s, const gx_body *body, const gx_blade *blade) {
    const gxp_glance *g = &blade->now.glance;
    const gx_blade *other;
    uint32_t i;
    for (other = body->blades; other != blade; other = other->next)
        gxp_require_true(s, !(g->ready && other->now.glance.ready));
    gxp_require_true(s, g->ready <= 1 && (!g->ready || blade->now.edge.count > 0));
    gxp_require_true(s, !g->ready || body->copies.struck != NULL || body->copies.count == 0);
    gxp_require_true(s, g->edge.count == 0 || (g->ready && g->edge.count == blade->now.edge.count));
    gxp_require_true(s, g->beads.count == 0 || g->ready);
    gxp_require_true(s, gxp_are_finite(g->edge.data, 3 * (size_t)g->edge.count) && g->travelled >= 0 && g->room >= 0 &&
                            g->course >= 0);
    for (i = 0; i < g->beads.count; i++)
        gxp_require_true(s, g->beads.data[i].along >= 0 && g->beads.data[i].along <= blade->now.edge.count &&
                                (g->cut != body->cuts.hash || (g->beads.data[i].cell < body->cells.count &&
                                                               body->cells.data[g->beads.data[i].cell].kept)));
}

/* Room for what a blade remembers, with these counts */
static gx_result gxp_blade_room(gx_body *body, gxp_blade_state *b, const uint32_t n[GXP_BLADE_LISTS]) {
    const gx_allocator *a = &body->config.allocator;
    gx_result result =
        gxp_reserve(a, &b->vertices.data, sizeof *b->vertices.data, 0, &b->vertices.capacity, n[GXP_BLADE_VERTICES]);
    if (result == GX_OK)
        result = gxp_reserve(a, &b->points.data, 3 * sizeof(double), 0, &b->points.capacity, n[GXP_BLADE_POINTS]);
    if (result == GX_OK)
        result = gxp_reserve(a, &b->layers.data, sizeof *b->layers.data, 0, &b->layers.capacity, n[GXP_BLADE_LAYERS]);
    if (result == GX_OK)
        result =
            gxp_reserve(a, &b->members.data, sizeof *b->members.data, 0, &b->members.capacity, n[GXP_BLADE_MEMBERS]);
    if (result == GX_OK)
        result = gxp_reserve(a, &b->edge.data, 3 * sizeof(double), 0, &b->edge.capacity, n[GXP_BLADE_EDGE]);
    if (result == GX_OK)
        result = gxp_reserve(a, &b->glance.beads.data, sizeof *b->glance.beads.data, 0, &b->glance.beads.capacity,
                             n[GXP_BLADE_BEADS]);
    if (result == GX_OK)
        result =
            gxp_reserve(a, &b->glance.edge.data, 3 * sizeof(double), 0, &b->glance.edge.capacity, n[GXP_BLADE_GLANCE]);
    if (result != GX_OK) return result;
    b->vertices.count = n[GXP_BLADE_VERTICES];
    b->points.count = n[GXP_BLADE_POINTS];
    b->layers.count = n[GXP_BLADE_LAYERS];
    b->members.count = n[GXP_BLADE_MEMBERS];
    b->edge.count = n[GXP_BLADE_EDGE];
    b->glance.beads.count = n[GXP_BLADE_BEADS];
    b->glance.edge.count = n[GXP_BLADE_GLANCE];
    return GX_OK;
}

static void gxp_load_blade(gxb_stream *s, gx_body *body, int trusted) {
    uint32_t n[GXP_BLADE_LISTS], i;
    gx_blade *b = NULL;
    gxp_require(s, gx_blade_create(body, NULL, &b, NULL));
    if (s->result != GX_OK) return;
    gxp_pass_blade_head(s, b, n);
    for (i = 0; i < GXP_BLADE_LISTS; i++) gxp_require_true(s, gxb_stream_has(s, n[i], sizeof(uint64_t)));
    if (s->result == GX_OK) gxp_require(s, gxp_blade_room(body, &b->now, n));
    if (s->result == GX_OK) gxp_pass_blade(s, &b->now);
    if (s->result == GX_OK && !trusted) gxp_check_strokes(s, body, b);
    if (s->result == GX_OK && !trusted) gxp_check_glance(s, body, b);
}

static void gxp_load_blades(gxb_stream *s, gx_body *body, int trusted) {
    uint32_t count = 0, i;
    gxp_pass_word(s, &count);
    for (i = 0; i < count && s->result == GX_OK; i++) gxp_load_blade(s, body, trusted);
}

/* Copies what a blade needs to leave out moves; there is room. */
static void gxp_copy_glance(gxp_glance *to, const gxp_glance *from) {
    if (from->beads.count > 0) memcpy(to->beads.data, from->beads.data, from->beads.count * sizeof *from->beads.data);
    if (from->edge.count > 0) memcpy(to->edge.data, from->edge.data, 3 * (size_t)from->edge.count * sizeof(double));
    to->ready = from->ready;
    to->travelled = from->travelled;
    to->room = from->room;
    to->course = from->course;
    to->cut = from->cut;
}

/* Makes ready that the body's blades become those of another: as many, and what these remember in `then`. made: how
   many it added. */
static gx_result gxp_prepare_blades(gx_body *body, const gx_body *from, uint32_t *made) {
    const gx_blade *source;
    gx_blade *b = body->blades;
    gx_result result = GX_OK;
    *made = 0;
    for (source = from->blades; source != NULL && result == GX_OK; source = source->next) {
        const gxp_blade_state *f = &source->now;
        uint32_t n[GXP_BLADE_LISTS];
        n[GXP_BLADE_VERTICES] = f->vertices.count;
        n[GXP_BLADE_POINTS] = f->points.count;
        n[GXP_BLADE_LAYERS] = f->layers.count;
        n[GXP_BLADE_MEMBERS] = f->members.count;
        n[GXP_BLADE_EDGE] = f->edge.count;
        n[GXP_BLADE_BEADS] = f->glance.beads.count;
        n[GXP_BLADE_GLANCE] = f->glance.edge.count;
        if (b == NULL) {
            result = gx_blade_create(body, NULL, &b, NULL);
            *made += result == GX_OK;
        }
        if (result == GX_OK) result = gxp_blade_room(body, &b->then, n);
        if (result != GX_OK) break;
        if (f->vertices.count > 0)
            memcpy(b->then.vertices.data, f->vertices.data, f->vertices.count * sizeof *f->vertices.data);
        if (f->points.count > 0) memcpy(b->then.points.data, f->points.data, 3 * f->points.count * sizeof(double));
        if (f->layers.count > 0) memcpy(b->then.layers.data, f->layers.data, f->layers.count * sizeof *f->layers.data);
        if (f->members.count > 0)
            memcpy(b->then.members.data, f->members.data, f->members.count * sizeof *f->members.data);
        if (f->edge.count > 0) memcpy(b->then.edge.data, f->edge.data, 3 * f->edge.count * sizeof(double));
        gxp_copy_glance(&b->then.glance, &f->glance);
        b->then.slot_count = f->slot_count;
        memcpy(b->then.middle, f->middle, sizeof f->middle);
        b = b->next;
    }
    return result;
}

/* The body's blades become those of another, as they were made ready. Those that it lacks are lifted. */
static void gxp_take_blades(gx_body *body, const gx_body *from) {
    const gx_blade *source = from->blades;
    gx_blade *b;
    for (b = body->blades; b != NULL; b = b->next) {
        const gxp_blade_state now = b->now;
        if (source == NULL) {
            gxp_forget(&b->now);
            continue;
        }
        b->now = b->then;
        b->then = now;
        b->tolerance = source->tolerance;
        b->min_advance = source->min_advance;
        b->max_samples = source->max_samples;
        b->starts_inside = source->starts_inside;
        source = source->next;
    }
}

/* Takes back blades that were added last. */
static void gxp_drop_blades(gx_body *body, uint32_t count) {
    uint32_t all = 0;
    gx_blade *b;
    for (b = body->blades; b != NULL; b = b->next) all++;
    for (; count > 0; count--, all--) gx_blade_destroy(gx_body_blade(body, all - 1));
}

/* >>save: state; save, load, clone, restore ------------------------------------------------------------------------ */
/* In: a body, or bytes. Out: bytes, or a body that goes on as the other does. On an error the body is as it was. */

/* The row counts of the state, whether there is a history, and whether a blade leaves out moves */
typedef struct gxp_state_counts {
    uint32_t rows[GXP_TABLES], history, struck;
    uint32_t contact, pressing, known; /* 1: contact is on; its states; the colliders of the last step */
    uint32_t touching;                 /* words of what touched */
    int affine;                        /* there may be affine copies: the saved mesh tells */
} gxp_state_counts;

static uint32_t gxp_state_use(const gxp_state_counts *n) {
    return GXP_STATE | (n->history ? (uint32_t)GXP_HISTORY : 0) | (n->struck ? (uint32_t)GXP_STROKE : 0) |
           (n->affine ? (uint32_t)GXP_AFFINE : 0);
}

static void gxp_pass_state_counts(gxb_stream *s, gxp_state_counts *n) {
    gxp_pass_counts(s, GXP_STATE, n->rows);
    gxp_pass_word(s, &n->history);
    gxp_pass_word(s, &n->struck);
    gxp_pass_word(s, &n->contact);
    gxp_pass_word(s, &n->pressing);
    gxp_pass_word(s, &n->known);
    gxp_pass_word(s, &n->touching);
}

static gxp_state_counts gxp_count_state(const gx_body *body) {
    gxp_state_counts n;
    gxp_count_rows(body, n.rows);
    n.history = body->copies.previous_dt > 0;
    n.struck = (uint32_t)gxp_has_glances(body);
    n.affine = body->copies.affine != NULL;
    n.contact = (uint32_t)body->touch.on;
    n.pressing = body->touch.on && body->touch.made ? body->touch.surfaces[body->touch.current].state_count : 0;
    n.known = body->touch.on ? body->touch.known_count : 0;
    n.touching = body->touch.on ? body->touch.touching.count : 0;
    return n;
}

/* The surface that gets the states of contact when they are read: the present one if it is of the present cuts */
static uint32_t gxp_arriving_surface(const gx_body *body) {
    const gxp_touch *t = &body->touch;
    return t->made && t->hash == body->cuts.hash ? t->current : 1 - t->current;
}

/* Room for the state of contact; the present one stays. */
static gx_result gxp_contact_room(gx_body *body, const gxp_state_counts *n) {
    const gx_allocator *a = &body->config.allocator;
    gxp_touch *t = &body->touch;
    gxp_touch_surface *to = &t->surfaces[gxp_arriving_surface(body)];
    gx_result result = gxp_reserve(a, &to->states, sizeof *to->states, to->state_count, &to->state_capacity,
                                   n->pressing > to->state_count ? n->pressing - to->state_count : 0);
    if (result == GX_OK)
        result =
            gxp_words_room(body, &t->touching, n->touching > t->touching.count ? n->touching - t->touching.count : 0);
    return result == GX_OK ? gxp_reserve(a, &t->known, sizeof *t->known, t->known_count, &t->known_capacity,
                                         n->known > t->known_count ? n->known - t->known_count : 0)
                           : result;
}

/* Writes the state of contact, or reads it if there is room. When reading, a surface that is not of the present cuts is
   still to be made, if something presses. */
static void gxp_pass_contact(gxb_stream *s, gx_body *body, const gxp_state_counts *n) {
    gxp_touch *t = &body->touch;
    gx_contact_desc *desc = &t->desc;
    gxp_touch_surface *to;
    uint32_t i;
    if (s->in != NULL) {
        const uint32_t arriving = gxp_arriving_surface(body);
        t->made = n->contact && (n->pressing > 0 || arriving == t->current);
        t->current = arriving;
        t->hash = body->cuts.hash;
        t->on = (int)n->contact;
        t->known_count = n->known;
        t->touching.count = n->touching;
        t->surfaces[arriving].state_count = n->pressing;
        t->kept = 0;
        t->pressed = 0;
    }
    if (!n->contact) return;
    to = &t->surfaces[t->current];
    gxb_stream_pass(s, &desc->stiffness, 1, sizeof(double));
    gxb_stream_pass(s, &desc->friction, 1, sizeof(double));
    gxb_stream_pass(s, &desc->sticking_speed, 1, sizeof(double));
    gxb_stream_pass(s, &desc->recovery, 1, sizeof(double));
    gxb_stream_pass(s, &desc->depth, 1, sizeof(double));
    gxp_pass_word(s, &desc->max_pairs);
    gxb_stream_pass(s, &t->pressed, 1, sizeof t->pressed);
    for (i = 0; i < n->known; i++) {
        gxp_pass_word(s, &t->known[i].id);
        gxb_stream_pass(s, &t->known[i].hash, 1, sizeof t->known[i].hash);
    }
    for (i = 0; i < n->touching; i++) gxp_pass_word(s, &t->touching.data[i]);
    for (i = 0; i < n->pressing; i++) {
        gxp_touch_state *state = &to->states[i];
        gxp_pass_word(s, &state->sample);
        gxp_pass_word(s, &state->other);
        gxb_stream_pass(s, &state->pressed, 1, sizeof(double));
        gxb_stream_pass(s, state->slip, 3, sizeof(double));
        gxb_stream_pass(s, state->rest, 3, sizeof(double));
    }
}

/* Room for a state with these counts; the present one stays. */
static gx_result gxp_state_room(gx_body *body, const gxp_state_counts *n) {
    gx_result result = gxp_rows_room(body, gxp_state_use(n), n->rows);
    if (result == GX_OK && n->struck) result = gxp_start_struck(body);
    if (result == GX_OK) result = gxp_contact_room(body, n);
    return result == GX_OK && n->history ? gxp_start_history(body, 2) : result;
}

/* Makes the solver forget its last step, as that of the other body has. Both make a model that is changed by cuts, or
   is to be, anew. */
static void gxp_resume_in(gx_body *body, const gxs_scene *scene) {
    gxs_solver_resume(body->solver, scene);
    if (body->model.updated || body->model.state == GXP_MODEL_CHANGED) body->model.state = GXP_MODEL_STALE;
    body->model.resumed = gxp_hash_state(body, body->copies.count);
}

/* Writes the state, or reads it if there is room. n: the counts of the body that is written. */
static void gxp_pass_state(gxb_stream *s, gx_body *body, const gxp_state_counts *n) {
    gxs_scene scene;
    gxp_pass_rows(s, body, gxp_state_use(n), n->rows);
    gxb_stream_pass(s, &body->copies.previous_dt, 1, sizeof body->copies.previous_dt);
    gxp_pass_word(s, &body->snapshot.next_id);
    gxp_pass_word(s, &body->snapshot.stale);
    gxs_solver_scene(body->solver, &scene);
    gxb_stream_pass(s, scene.gravity, 3, sizeof *scene.gravity);
    gxb_stream_pass(s, &scene.planes, 1, sizeof scene.planes);
    gxb_stream_pass(s, &scene.forces, 1, sizeof scene.forces);
    gxb_stream_pass(s, &scene.springs, 1, sizeof scene.springs);
    gxp_pass_contact(s, body, n);
    if (s->in == NULL) return;
    gxp_find_bends(body);
    gxp_resume_in(body, &scene);
}

static void gxp_save_state(gxb_stream *s, gx_body *body) {
    gxp_state_counts n = gxp_count_state(body);
    gxp_pass_state_counts(s, &n);
    gxp_pass_state(s, body, &n);
}

/* Has the region as many indices and vertices as its kind can have? */
static int gxp_is_region_whole(const gxp_region *r) {
    const uint32_t indices = r->index_count, vertices = r->vertex_count;
    switch (r->kind) {
    case GX_REGION_SURFACE: return indices > 0 && indices % 3 == 0 && vertices > 0;
    case GX_REGION_NODES: return indices > 0 && vertices == 0;
    case GX_REGION_ANCHORS: return indices > 0 && vertices % 2 == 0 && vertices / 2 == indices;
    default: return indices == 0 && vertices == 0;
    }
}

/* Regions have their indices and vertices one after the other, and nothing else is there. */
static void gxp_check_regions(gxb_stream *s, gx_body *body) {
    const gxp_holds *holds = &body->holds;
    uint32_t i, indices = 0, vertices = 0;
    for (i = 0; i < holds->count && s->result == GX_OK; i++) {
        const gxp_region *r = &holds->regions[i];
        gx_result result;
        gxp_require_true(s, r->kind <= GX_REGION_ANCHORS && r->zero == 0 && gxp_is_region_whole(r));
        gxp_require_true(s, r->first_index == indices && r->index_count <= holds->index_count - indices);
        gxp_require_true(s, r->first_vertex == vertices && r->vertex_count <= holds->vertex_count - vertices);
        if (s->result != GX_OK) return;
        indices += r->index_count;
        vertices += r->vertex_count;
        result = gxp_check_region(body, r, i, NULL);
        gxp_require(s, result == GX_OK || result == GX_ERROR_MEMORY ? result : GX_ERROR_DAMAGED);
    }
    gxp_require_true(s, indices == holds->index_count && vertices == holds->vertex_count);
}

static void gxp_check_state(gxb_stream *s, gx_body *body, const gxp_state_counts *n) {
    const gxp_snapshot *snapshot = &body->snapshot;
    const double dt = body->copies.previous_dt;
    uint32_t i;
    gxp_require_true(s, snapshot->next_id >= 1 && snapshot->stale <= 1);
    gxp_require_true(s, gxp_is_finite(dt) && (n->history ? dt > 0 : !(dt > 0 || dt < 0)));
    gxp_check_regions(s, body);
    for (i = 0; i < body->copies.count; i++)
        gxp_require_true(s,
                         body->copies.label[i] >> 1 < snapshot->count && (!n->affine || body->copies.affine[i] <= 1));
    for (i = 0; i < snapshot->count; i++)
        gxp_require_true(s, snapshot->id[i] - 1 < snapshot->next_id - 1 &&
                                snapshot->origin[i] - 1 < snapshot->next_id - 1 &&
                                snapshot->change[i] <= GX_FRAGMENT_CREATED);
    for (i = 0; i < snapshot->removed.count; i++)
        gxp_require_true(s, snapshot->removed.data[i] - 1 < snapshot->next_id - 1);
    if (s->result == GX_OK) gxp_require(s, gxp_update_view(body));
    gxp_require_true(s, snapshot->stale || body->view.fragment_count == snapshot->count);
}

/* Are contact's numbers such that a step made them? Those of samples are checked when the surface is there. */
static void gxp_check_contact(gxb_stream *s, const gx_body *body, const gxp_state_counts *n) {
    const gxp_touch *t = &body->touch;
    const gxp_touch_surface *own = &t->surfaces[t->current];
    const double numbers[5] = {t->desc.stiffness, t->desc.friction, t->desc.sticking_speed, t->desc.recovery,
                               t->desc.depth};
    uint32_t i;
    int k;
    if (!n->contact) return;
    gxp_require_true(s, numbers[0] > 0 && numbers[4] > 0);
    for (i = 0; i < 5; i++) gxp_require_true(s, gxp_is_finite(numbers[i]) && numbers[i] >= 0);
    for (i = 1; i < n->known; i++) gxp_require_true(s, t->known[i - 1].id < t->known[i].id);
    for (i = 3; i < n->touching; i += 3)
        gxp_require_true(s, gxp_compare_touching(t->touching.data + i - 3, t->touching.data + i) < 0);
    for (i = 0; i < n->pressing; i++) {
        const gxp_touch_state *state = &own->states[i];
        gxp_require_true(s, i == 0 || own->states[i - 1].sample <= state->sample);
        gxp_require_true(s, gxp_is_finite(state->pressed) && state->pressed >= 0);
        for (k = 0; k < 3; k++) gxp_require_true(s, gxp_is_finite(state->slip[k]) && gxp_is_finite(state->rest[k]));
    }
}

/* Makes the surface of contact of a body that was read, if something presses there. */
static void gxp_load_contact(gxb_stream *s, gx_body *body, const gxp_state_counts *n) {
    gxp_touch_surface *own = &body->touch.surfaces[body->touch.current];
    if (n->pressing == 0) return;
    gxp_require(s, gxp_make_surface(body, own));
    gxp_require_true(s, own->states[n->pressing - 1].sample < own->vertex_count + own->facet_count);
}

static void gxp_load_state(gxb_stream *s, gx_body *body, int trusted) {
    gxp_state_counts n;
    n.affine = body->copies.affine != NULL;
    gxp_pass_state_counts(s, &n);
    gxp_check_counts(s, gxp_state_use(&n), n.rows);
    gxp_require_true(s, n.rows[GXP_COPIES] == body->copies.count && n.history <= 1 && n.struck <= 1 && n.contact <= 1 &&
                            (n.contact || (n.pressing == 0 && n.known == 0 && n.touching == 0)));
    gxp_require_true(s, n.touching % 3 == 0);
    gxb_stream_has(s, n.pressing, 2 * sizeof(uint32_t) + 7 * sizeof(double));
    gxb_stream_has(s, n.known, sizeof(uint32_t) + sizeof(uint64_t));
    gxb_stream_has(s, n.touching, sizeof(uint32_t));
    if (s->result == GX_OK) gxp_require(s, gxp_state_room(body, &n));
    if (s->result == GX_OK) gxp_pass_state(s, body, &n);
    if (s->result == GX_OK && !trusted) gxp_check_state(s, body, &n);
    if (s->result == GX_OK && !trusted) gxp_check_contact(s, body, &n);
    if (s->result == GX_OK) gxp_load_contact(s, body, &n);
}

static void gxp_write(gxb_stream *s, gx_body *body) {
    gxp_head head = gxp_make_head(0, 0);
    gxp_pass_head(s, &head);
    gxp_save_mesh(s, body);
    gxp_save_topology(s, body);
    gxp_save_state(s, body);
    gxp_save_blades(s, body);
}

static void gxp_resume(gx_body *body) {
    gxs_scene scene;
    gxs_solver_scene(body->solver, &scene);
    gxp_resume_in(body, &scene);
}

GXFEM_API gx_result gx_body_save(gx_body *body, void *memory, size_t capacity, size_t *size, gx_failure *failure) {
    gxb_stream s;
    size_t start;
    gxp_head head;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (size == NULL) return gxp_refuse(failure, "size");
    result = gxp_refresh_contact(body);
    if (gxp_end(failure, result) != GX_OK) return result;
    gxp_note_written(body);
    memset(&s, 0, sizeof s);
    gxp_pass_head(&s, &head);
    start = s.at;
    s.at = 0;
    gxp_write(&s, body);
    *size = s.at;
    if (memory == NULL) return GX_OK;
    if (capacity < s.at) return gxp_fail(failure, GX_ERROR_CAPACITY, "capacity", SIZE_MAX);
    s.out = (unsigned char *)memory;
    s.size = s.at;
    s.at = 0;
    gxp_write(&s, body);
    s.at = 0;
    head = gxp_make_head(s.size, gxp_hash_bytes(0, s.out + start, s.size - start));
    gxp_pass_head(&s, &head);
    gxp_resume(body);
    return GX_OK;
}

static gx_result gxp_read(gxb_stream *s, const gx_body_desc *desc, int trusted, gx_body **body, gx_failure *failure) {
    gx_body *made = NULL;
    gxp_head head;
    if (trusted)
        gxp_pass_head(s, &head);
    else
        s->result = gxp_check_head(s);
    gxp_end(failure, GX_OK);
    if (s->result == GX_OK) gxp_load_mesh(s, desc, &made, failure);
    if (s->result == GX_OK) gxp_load_topology(s, made, trusted);
    if (s->result == GX_OK) gxp_load_state(s, made, trusted);
    if (s->result == GX_OK) gxp_load_blades(s, made, trusted);
    gxp_require_true(s, s->at == s->size);
    if (s->result == GX_OK)
        *body = made;
    else
        gx_body_destroy(made);
    return s->result == GX_ERROR_FORMAT || s->result == GX_ERROR_DAMAGED ? gxp_fail(failure, s->result, "memory", s->at)
                                                                         : gxp_close(failure, s->result);
}

GXFEM_API gx_result gx_body_load(const void *memory, size_t size, const gx_body_desc *desc, gx_body **body,
                                 gx_failure *failure) {
    gx_body_desc none;
    gxb_stream s;
    memset(&none, 0, sizeof none);
    if (desc == NULL) desc = &none;
    if (memory == NULL) return gxp_refuse(failure, "memory");
    if (body == NULL) return gxp_refuse(failure, "body");
    if (!gxb_is_allocator(&desc->allocator)) return gxp_refuse(failure, "allocator");
    memset(&s, 0, sizeof s);
    s.in = (const unsigned char *)memory;
    s.size = size;
    return gxp_read(&s, desc, 0, body, failure);
}

/* Makes a body like `from` with the allocator, clock and jobs of host. */
static gx_result gxp_copy_body(gx_body *from, const gx_body *host, gx_body **copy) {
    gx_body_desc desc;
    gxb_stream s;
    unsigned char *bytes;
    size_t size = 0;
    gx_result result = gx_body_save(from, NULL, 0, &size, NULL);
    if (result != GX_OK) return result;
    bytes = (unsigned char *)gxp_allocate(&host->config.allocator, size);
    if (bytes == NULL) return GX_ERROR_MEMORY;
    memset(&s, 0, sizeof s);
    s.out = bytes;
    s.size = size;
    gxp_write(&s, from);
    memset(&s, 0, sizeof s);
    s.in = bytes;
    s.size = size;
    memset(&desc, 0, sizeof desc);
    desc.allocator = host->config.allocator;
    desc.clock = host->config.clock;
    desc.clock_user = host->config.clock_user;
    desc.jobs = host->config.jobs;
    desc.materials = from->mesh.materials;
    desc.material_count = from->mesh.material_count;
    result = gxp_read(&s, &desc, 1, copy, NULL);
    gxp_release(&host->config.allocator, bytes, size);
    if (result == GX_OK) gxp_resume(from);
    return result;
}

GXFEM_API gx_result gx_body_clone(gx_body *body, gx_body **clone, gx_failure *failure) {
    if (body == NULL) return gxp_refuse(failure, "body");
    if (clone == NULL) return gxp_refuse(failure, "clone");
    return gxp_end(failure, gxp_copy_body(body, body, clone));
}

static int gxp_same_doubles(const double *a, const double *b, size_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static int gxp_same_materials(const gx_body *a, const gx_body *b) {
    uint32_t i;
    int same = a->mesh.material_count == b->mesh.material_count;
    for (i = 0; i < a->mesh.material_count && same; i++) {
        const gxs_material *p = &a->mesh.materials[i].elastic, *q = &b->mesh.materials[i].elastic;
        same = p->kind == q->kind && gxp_same_doubles(&p->young, &q->young, 1) &&
               gxp_same_doubles(&p->poisson, &q->poisson, 1) && gxp_same_doubles(&p->damping, &q->damping, 1) &&
               gxp_same_doubles(&a->mesh.materials[i].density, &b->mesh.materials[i].density, 1) &&
               (p->kind != GXS_CUSTOM || (p->energy == q->energy && p->user == q->user));
    }
    return same;
}

static int gxp_same_regions(const gx_body *a, const gx_body *b) {
    const gxp_holds *p = &a->holds, *q = &b->holds;
    return p->count == q->count && p->index_count == q->index_count && p->vertex_count == q->vertex_count &&
           (p->count == 0 || memcmp(p->regions, q->regions, p->count * sizeof *p->regions) == 0) &&
           (p->index_count == 0 || memcmp(p->indices, q->indices, p->index_count * sizeof *p->indices) == 0) &&
           (p->vertex_count == 0 || gxp_same_doubles(p->vertices, q->vertices, 3 * (size_t)p->vertex_count));
}

/* Copies the state of a body with the same cells and copies. */
static gx_result gxp_restore_state(gx_body *body, gx_body *from) {
    const int same_held = gxp_same_regions(body, from);
    gxp_state_counts n;
    gxb_stream s;
    unsigned char *bytes;
    size_t size;
    gx_result result = gxp_refresh_contact(from);
    if (result != GX_OK) return result;
    n = gxp_count_state(from);
    result = gxp_state_room(body, &n);
    if (result == GX_OK && n.pressing > 0 && gxp_arriving_surface(body) != body->touch.current)
        result = gxp_make_surface(body, &body->touch.surfaces[1 - body->touch.current]);
    if (result != GX_OK) return result;
    gxp_note_written(from);
    memset(&s, 0, sizeof s);
    gxp_pass_state(&s, from, &n);
    size = s.at;
    bytes = (unsigned char *)gxp_allocate(&body->config.allocator, size);
    if (bytes == NULL) return GX_ERROR_MEMORY;
    s.out = bytes;
    s.size = size;
    s.at = 0;
    gxp_pass_state(&s, from, &n);
    s.in = bytes;
    s.out = NULL;
    s.at = 0;
    gxp_pass_state(&s, body, &n);
    gxp_release(&body->config.allocator, bytes, size);
    if (!same_held) {
        memset(body->copies.held, 0, body->copies.count);
        body->holds.listed = 0;
        body->holds.stale = 1;
        body->model.state = GXP_MODEL_STALE;
    }
    gxp_resume(from);
    return GX_OK;
}

/* Replaces cells and all else by a copy of another body's. The body's own blades stay, and the copy's go with the old
   body. */
static gx_result gxp_restore_all(gx_body *body, gx_body *from) {
    gx_body *copy, swap;
    const gx_result result = gxp_copy_body(from, body, &copy);
    if (result != GX_OK) return result;
    swap = *body;
    *body = *copy;
    *copy = swap;
    copy->blades = body->blades;
    body->blades = swap.blades;
    gx_body_destroy(copy);
    return GX_OK;
}

GXFEM_API gx_result gx_body_restore(gx_body *body, gx_body *from, gx_failure *failure) {
    uint32_t made;
    gx_result result;
    if (body == NULL) return gxp_refuse(failure, "body");
    if (from == NULL) return gxp_refuse(failure, "from");
    if (body == from) return gxp_end(failure, GX_OK);
    result = gxp_prepare_blades(body, from, &made);
    if (result == GX_OK)
        result = body->cuts.hash == from->cuts.hash && body->copies.count == from->copies.count &&
                         body->cells.count == from->cells.count && body->slots.count == from->slots.count &&
                         body->leaves.count == from->leaves.count && gxp_same_materials(body, from)
                   ? gxp_restore_state(body, from)
                   : gxp_restore_all(body, from);
    if (result == GX_OK)
        gxp_take_blades(body, from);
    else
        gxp_drop_blades(body, made);
    return gxp_end(failure, result);
}

#undef GXP_COLD
#undef GXP_APART
#undef GXP_PREFETCH
#undef GXP_PREFETCHES
#undef GXP_NONE
#undef GXP_SUPPORT
#undef GXP_SPECK
#undef GXP_SPECK_REACH
#undef GXP_PLANE_GROUP
#undef GXP_COLUMN
#undef GXP_TABLE
#undef GXP_LIST
#undef GXP_WORDS
#undef GXP_KEYS
#undef GXP_HAS_ROOM
#undef GXP_FIRST
#undef GXP_SECOND
#undef GXP_LINK_CELL
#undef GXP_LINK_FACET
#undef GXP_LINK_FACE
#undef GXP_SEARCH_MARGIN
#undef GXP_TOUCH_CREASE
#undef GXP_TOUCH_LEAF
#undef GXP_TOUCH_EVEN
#undef GXP_TOUCH_APART
#undef GXP_TOUCH_SHARE
#undef GXP_TOUCH_FACING
#undef GXP_TOUCH_NEAR
#undef GXP_TOUCH_ADVANCES
#undef GXP_TOUCH_FINE
#undef GXP_TOUCH_PARTS
#undef GXP_TOUCH_FLAT
#undef GXP_TOUCH_BESIDE
#undef GXP_TOUCH_SLANT
#undef GXP_TOUCH_SAME
#undef GXP_TOUCH_BEHIND
#undef GXP_TOUCH_ALIKE
#undef GXP_TOUCH_COPIES
#undef GXP_TREE_LEAVES
#undef GXP_TREE_LEAF
#undef GXP_TREE_MARGIN
#undef GXP_TREE_ALL
#undef GXP_TREE_BEYOND
#undef GXP_NEAR_MARGIN
#undef GXP_NEAR_ROUNDING
#undef GXP_LOCATE_FEW
#undef GXP_GROUP_POINTS
#undef GXP_GROUP_ELEMENTS
#undef GXP_RAY_MARGIN
#undef GXP_REACH
#undef GXP_WEIGHT
#undef GXP_AFFINE_MOST
#undef GXP_UNBEND_STEPS
#undef GXP_UNBEND_SMALL
#undef GXP_LAST_ROUND
#undef GXP_EXPECTED
#undef GXP_CANCELLATION
#undef GXP_BOUNDARY_POINTS
#undef GXP_FIXED_VOLUME
#undef GXP_REST_CELLS
#undef GXP_REST
#undef GXP_WEIGHT_LOSS
#undef GXP_ROUNDING
#undef GXP_ELEMENT_SPREAD
#undef GXP_OFF
#undef GXP_NO_INERTIA
#undef GXP_SAVE_VERSION
#undef GXP_BYTE_ORDER
#undef GXP_BESIDE_WALL
#undef GXP_ACROSS_WALL
#undef GXP_BESIDE_OPEN
#undef GXP_NO_PLANE
#undef GXP_BEAD_REACH
#undef GXP_BEAD_OFF
#undef GXP_GLANCE_ROOM
#undef GXP_BEAD_COURSE
#undef GXP_LEAST_GLANCE
#undef GXP_BEAD_FACES
#undef GXP_BEAD_TOUCH
#undef GXP_NEAR_SLACK
#undef GXP_BLOWN_MAP
#undef GXP_FLAT_MAP
#undef GXP_CAP
#undef GXP_SURELY
#undef GXP_AIR
#undef GXP_LEAP
#undef GXP_SAME_WAY
#undef GXP_STAYED
#undef GXP_LEAST_ADVANCE
#undef GXP_CHORD_HALVES
#undef GXP_CHORD_OFF
#undef GXP_CUT_WIDTH
#undef GXP_ON_SHEET
#undef GXP_BLADE_SPECK
#undef GXP_SPECK_TRIES
#undef GXP_SECTION
#undef GXP_CROSSING
#undef GXP_SHEET_TRIANGLES
#undef GXP_STRIP_REACH
#undef GXP_TOUCH
#undef GXP_TOUCH_ROUNDING
#undef GXP_LEAST_CONTACT
#undef GXP_CONTACT_SPACING
#undef GXP_EDGE_REACH
#undef GXP_TOOL_TRIANGLES
#undef GXP_GRID_CUBES
#undef GXP_GRID_MARGIN
#ifdef GXFEM_SCALAR
#pragma clang attribute pop
#endif
#ifdef __cplusplus
}
#endif
#endif /* GXFEM_IMPLEMENTED */
